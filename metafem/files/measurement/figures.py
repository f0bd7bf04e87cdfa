"""Figures as SVG or PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from metafem import drawing
from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.atomic.text import refuse_existing, write_file, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The beginning of the content of each format.
STARTS = {".svg": b"<svg", ".png": b"\x89PNG"}


def refuse_figure(path: Path, force: bool) -> None:
    """Raise InvalidInput for another format, or if `write_figure` would refuse the file."""
    if path.suffix.lower() not in STARTS:
        raise InvalidInput(f"{printable(str(path))} must end with .svg or .png, the formats of figures")
    refuse_existing(path, force, _is_figure)


def write_figure(path: Path, figure: Figure, title: str, *, force: bool = False) -> None:
    """Write a figure in the format that the name of the file says."""
    refuse_figure(path, force)
    if path.suffix.lower() == ".svg":
        write_text(path, drawing.svg(figure, title) + "\n", force=force, ours=_is_figure)
    else:
        write_file(
            path,
            lambda fresh: figure.savefig(fresh, format="png", dpi=drawing.RESOLUTION),
            force=force,
            ours=_is_figure,
        )


def _is_figure(content: bytes) -> bool:
    return content.startswith(tuple(STARTS.values()))
