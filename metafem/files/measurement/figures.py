"""Figures as SVG or PNG files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from metafem import drawing
from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.atomic import refuse_existing, write_file, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The beginning of the content of each format.
STARTS = {".svg": b"<svg", ".png": b"\x89PNG"}

# A figure in PNG says in its first chunk of text that it is a drawing; pictures of cameras do not.
SOFTWARE = "metafem"
FIRST_CHUNKS = 200


def refuse_figure(path: Path, force: bool) -> None:
    """Raise InvalidInput for another format, or if `write_figure` would refuse the file."""
    if path.suffix.lower() not in STARTS:
        raise InvalidInput(f"{printable(str(path))} must end with .svg or .png, the formats of figures")
    refuse_existing(path, force, is_figure)


def write_figure(path: Path, figure: Figure, title: str, *, force: bool = False) -> None:
    """Write a figure in the format that the name of the file says."""
    refuse_figure(path, force)
    if path.suffix.lower() == ".svg":
        write_text(path, drawing.svg(figure, title) + "\n", force=force, ours=is_figure)
    else:
        write_file(
            path,
            lambda fresh: figure.savefig(
                fresh, format="png", dpi=drawing.RESOLUTION, metadata={"Software": SOFTWARE}
            ),
            force=force,
            ours=is_figure,
        )


def is_figure(content: bytes) -> bool:
    """Whether the content of a file, or its beginning, is that of a figure of `write_figure`."""
    if content.startswith(STARTS[".svg"]):
        return True
    software = f"Software\0{SOFTWARE}".encode()
    return content.startswith(STARTS[".png"]) and software in content[:FIRST_CHUNKS]
