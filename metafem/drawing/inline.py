"""Figures as parts of a page: SVG in the colours of the page, with a caption."""

from __future__ import annotations

import re
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
FONT = re.compile(r"font-family: ([^;\"]*sans-serif);? ?")
IDENTIFIER = re.compile(r' id="([^"]*)"')
COORDINATES = re.compile(r' (?:d|x|y|x1|x2|y1|y2)="[^"]*"')

# Coordinates, in points of 1/72 inch, with more than two decimals; the further decimals are removed.
LONG_NUMBER = re.compile(r"(\.\d\d)\d+")


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

    Unused identifiers, repeated font names and invisible digits are left out.
    """
    used = set(re.findall(r'#([^")]+)["\)]', text))
    text = IDENTIFIER.sub(lambda found: found[0] if found[1] in used else "", text)
    text = COORDINATES.sub(lambda found: LONG_NUMBER.sub(r"\1", found[0]), text)
    text = COLOUR.sub(lambda found: f"var({VARIABLES[found[0]]}, {found[0]})", text)
    fonts = FONT.search(text)
    style = f' style="font-family: {fonts[1]}"' if fonts else ""
    return FONT.sub("", text).replace("<svg ", f'<svg role="img"{style} ', 1)
