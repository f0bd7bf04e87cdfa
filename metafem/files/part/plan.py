"""The files of a part: options, checks and writing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from metafem import _validate as check
from metafem._values import MICROMETRES
from metafem.caps import SPHERE
from metafem.errors import refuse_if
from metafem.files.part.block import block_mesh, mould_mesh, triangle_count
from metafem.files.part.caps import refuse_impossible, with_alignment
from metafem.files.part.mould import DWELL, FEED, SAFE, SPINDLE, drilled
from metafem.files.part.stl import stl_size, write_stl
from metafem.notes import Note, information
from metafem.progress import doing, message
from metafem.surface import Block, Surface

# Files of a part.
FILES = ("block.stl", "mould.stl")

# Default chord error as a fraction of the smallest radius. For the source paper's radius of 526 um it is
# 0.2 um, a quarter of the 0.9 um accuracy of the paper's moulds (doi:10.1126/science.adk4234).
FINE = 4e-4

# Largest number of triangles of a solid if no chord error is stated: 100 MB of STL, which common viewers and
# CAM programs can open. A cap has about pi h / (chord error) triangles, for any radius.
MOST_BY_DEFAULT = 2_000_000

# Largest number of triangles of a solid in all cases: 500 MB of STL and a gigabyte of memory.
MOST = 10_000_000

# Factor by which the default chord error is increased until the solid has few enough triangles.
COARSER = 1.1


@dataclass(frozen=True)
class PartOptions:
    """Options of the files to make a part.

    Parameters
    ----------
    alignment_height : float, optional
        Height of four alignment asperities outside the corners of the template [mm].
    chord_error : float, optional
        Largest depth of the faces of the mesh below the true caps [mm]. It acts like an error of the height:
        at a given separation, the contact area of an asperity changes by at most ``pi R`` times the chord
        error. Most of this change equals that of a common shift of all caps, which does not affect A0(P).
        Default: 4e-4 of the smallest radius, or more if a solid would have over two million triangles.
    feed, spindle, dwell, safe_height : float
        Feed of the plunge [mm/min], speed of the spindle [1/min], dwell at the bottom of each hole [s], and
        height of the tool above the mould between two holes [mm], in ``mould.gcode``.

    Examples
    --------
    >>> PartOptions(chord_error=1e-3).chord_error
    0.001
    """

    alignment_height: float | None = None
    chord_error: float | None = None
    feed: float = FEED
    spindle: float = SPINDLE
    dwell: float = DWELL
    safe_height: float = SAFE

    def __post_init__(self) -> None:
        for name in ("alignment_height", "chord_error"):
            check.member(self, name, optional=True, above=0.0)
        for name in ("feed", "spindle", "safe_height"):
            check.member(self, name, above=0.0)
        check.member(self, "dwell", at_least=0.0)


@dataclass(frozen=True, eq=False)
class Part:
    """A part whose caps can be made, with the options of its files."""

    surface: Surface  # its asperities, followed by its alignment asperities
    asperities: int  # number of asperities without those for alignment
    block: Block
    chord_error: float  # [mm]
    options: PartOptions

    @cached_property
    def triangles(self) -> int:
        """Number of triangles of the part, and of its mould."""
        return triangle_count(self.surface.height, self.surface.radius, self.chord_error, self.surface.cap)

    @property
    def caps(self) -> str:
        """Description of the caps."""
        return "spheres" if self.surface.cap == SPHERE else "caps"

    def record(self) -> dict[str, Any]:
        """Return chord error, number of triangles and names of the files, for JSON."""
        return {
            "chord_error_mm": self.chord_error,
            "triangles": self.triangles,
            "files": list(FILES),
        }

    def size(self) -> str:
        """Return a text with the names of the solids, their size and their chord error."""
        megabytes = stl_size(self.triangles) / 1e6
        return (
            f"{', '.join(FILES)}: {self.triangles:,} triangles and {megabytes:.3g} MB each, "
            f"at most {self.chord_error * MICROMETRES:.2g} um below the {self.caps}"
        )

    def write(self, folder: Path) -> None:
        """Write the solids into a folder."""
        message(self.size())
        with doing("meshing the part"):
            block = block_mesh(self.surface, self.block, self.chord_error)
            mould = mould_mesh(block, self.surface, self.block)
        with doing("writing the part"):
            write_stl(block, folder / "block.stl", "block")
            write_stl(mould, folder / "mould.stl", "mould")


def planned(surface: Surface, template: Surface, options: PartOptions) -> Part | None:
    """Return the part of a surface, or None if the surface has no block.

    Raises
    ------
    InvalidInput
        If a cap cannot be made, or if the chord error needs too many triangles.
    """
    whole = with_alignment(surface, template, options.alignment_height)
    if surface.block is None:
        return None
    refuse_impossible(whole, surface.block, surface.count)
    fine = FINE * float(whole.radius.min())
    part = Part(whole, surface.count, surface.block, options.chord_error or fine, options)
    if options.chord_error is None:
        while part.triangles > MOST_BY_DEFAULT and part.chord_error < float(whole.radius.max()):
            part = replace(part, chord_error=COARSER * part.chord_error)
    words = (
        f"needs {part.triangles:.2g} triangles; at most {MOST:,} are written; choose a larger one, or leave"
    )
    given = f"{part.chord_error * MICROMETRES:g} um"
    wrong = options.chord_error is not None and part.triangles > MOST
    refuse_if(wrong, f"{words} it out", key="part.chord_error", value=given)
    return part


def part_notes(part: Part | None) -> tuple[Note, ...]:
    """Return notes if no part or no drilling program was written, or on an increased chord error."""
    if part is None:
        words = "no part was written: the surface has no block; add a block with width, length and thickness"
        return (information(words),)
    notes = []
    if not drilled(part.surface):
        words = "mould.gcode was not written: one ball-end mill cannot make all holes of mould.csv"
        notes.append(information(words))
    if part.options.chord_error is None and part.chord_error > FINE * float(part.surface.radius.min()):
        depth = f"up to {part.chord_error * MICROMETRES:.2g} um below the {part.caps}"
        words = f"the solids have {part.triangles:,} triangles, {depth}; part.chord_error sets this depth"
        notes.append(information(words))
    return tuple(notes)
