"""Figures as parts of a page: SVG in the colours of the page, with a caption."""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from metafem.drawing import ACHIEVED, MEASURED, MEASURED_BESIDE, QUIET, TARGET, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# CSS variables of a page for the colours of a figure; a page without the variables shows these colours.
VARIABLES = {
    "#000000": "--ink",
    "#ffffff": "--paper",
    TARGET: "--target",
    ACHIEVED: "--achieved",
    MEASURED: "--measured",
    MEASURED_BESIDE: "--beside",
    QUIET: "--faint",
    "#808080": "--faint",  # matplotlib's grey
    "#cccccc": "--line",  # frames of its legends
}

COLOUR = re.compile("|".join(VARIABLES))
IDENTIFIER = re.compile(r' id="([^"]*)"')
TITLE = re.compile("<title>(.*?)</title>", re.DOTALL)
REFERENCE = re.compile(r'((?:href="|url\()#)([^")]+)')

# Coordinates, in points of 1/72 inch, and numbers with more than two decimals, which are rounded.
COORDINATES = re.compile(r' (?:d|x|y|x1|x2|y1|y2)="[^"]*"|rotate\([^)]*\)')
LONG_NUMBER = re.compile(r"-?\d+\.\d{3,}")


@dataclass(frozen=True)
class Drawn:
    """A figure of a page: its title, an explanatory caption and its picture as SVG."""

    title: str
    caption: str
    svg: str


def drawn(figure: Figure, title: str, caption: str = "") -> Drawn:
    """Return a figure as a part of a page."""
    return Drawn(title, caption, themed(svg(figure, title)))


def themed(text: str) -> str:
    """Return an SVG element whose colours are CSS variables of the page, in fewer bytes.

    Unused identifiers and invisible digits are left out. The names of the others are
    numbers: matplotlib makes them from all digits of the data, and equal pictures would differ.
    """
    title = zlib.crc32(TITLE.findall(text)[0].encode())
    used = dict.fromkeys(found[1] for found in REFERENCE.findall(text))
    names = {name: f"f{title:x}-{i}" for i, name in enumerate(used)}
    text = IDENTIFIER.sub(lambda found: f' id="{names[found[1]]}"' if found[1] in names else "", text)
    text = REFERENCE.sub(lambda found: found[1] + names[found[2]], text)
    text = COORDINATES.sub(lambda found: LONG_NUMBER.sub(_rounded, found[0]), text)
    text = COLOUR.sub(lambda found: f"var({VARIABLES[found[0]]}, {found[0]})", text)
    return text.replace("<svg ", '<svg role="img" ', 1)


def _rounded(number: re.Match[str]) -> str:
    return f"{round(float(number[0]), 2) + 0.0:g}"  # the sum has no negative zero
