"""Writing of figures as SVG or PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from metafem import drawing
from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.atomic import refuse_existing, write_file, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = (".svg", ".png")

# Text at the beginning of each figure, by which `metafem images` recognises it.
MARK = "figure by metafem"


def refuse_figure(path: Path, force: bool) -> None:
    """Raise InvalidInput if `write_figure` would refuse the file; only .svg and .png are written."""
    if path.suffix.lower() not in FORMATS:
        raise InvalidInput(f"{printable(str(path))} must end with .svg or .png, the formats of figures")
    refuse_existing(path, force)


def write_figure(path: Path, figure: Figure, title: str, *, force: bool = False) -> None:
    """Write a figure; the extension of the file determines its format."""
    refuse_figure(path, force)
    if path.suffix.lower() == ".svg":
        text = f"<!-- {MARK} -->\n{drawing.svg(figure, title)}\n"
        write_text(path, text, force=force)
        return
    options: dict[str, Any] = {"format": "png", "dpi": drawing.RESOLUTION, "metadata": {"Software": MARK}}
    write_file(path, lambda fresh: figure.savefig(fresh, **options), force=force)
