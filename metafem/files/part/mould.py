"""The holes of a mould: their table, and a drilling program for a ball-end mill (ISO 6983)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, repeat
from typing import TYPE_CHECKING

import numpy as np

from metafem._values import MICROMETRES
from metafem.caps import SPHERE
from metafem.files.caps import caps_column
from metafem.files.part.block import mirrored
from metafem.inversion import Design
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.files.part.plan import PartOptions

# Decimals of a length in millimetres: a hundredth of a micrometre, a tenth of what machines position.
DECIMALS = 5

# Defaults of the feed of the plunge [mm/min], the speed of the spindle [1/min], the dwell at the bottom of a
# hole [s] and the height of the tool above the mould between two holes [mm], for small carbide ball-end mills
# in aluminium or brass.
FEED, SPINDLE, DWELL, SAFE = 20.0, 8000.0, 0.5, 5.0


def mould_table(design: Design, part: Surface) -> str:
    """Return the text of mould.csv: one hole for each summit, of kind "asperity" or "alignment".

    `part` holds the asperities of the design, followed by the alignment asperities. Sites are numbered as in
    ``heights.csv``. The depth of a hole below the face of the mould is the height of its summit, and the
    radius of its tool is the radius of the summit.
    """
    more, sites = caps_column(part), chain(design.sites.tolist(), repeat(""))
    lines = [f"# {line}" for line in _head(design, part)]
    lines.append(",".join(("number", "kind", "site", "x_mm", "y_mm", "depth_mm", "tool_radius_mm", *more)))
    rows = zip(sites, *mirrored(part.position).T, part.height, part.radius, *more.values(), strict=False)
    for number, (site, *lengths) in enumerate(rows, 1):
        kind = "alignment" if site == "" else "asperity"
        texts = (each if isinstance(each, str) else number_text(each) for each in lengths)
        lines.append(",".join((str(number), kind, str(site), *texts)))
    return "\n".join(lines) + "\n"


def drilling_program(part: Surface, options: PartOptions) -> str | None:
    """Return the text of mould.gcode, or None if the holes need more than one ball-end mill.

    The tool plunges into each hole to the depth of its cap, dwells and returns to the safe height. Z is 0 at
    the face of the mould; X and Y are those of mould.csv. There is no tool change.
    """
    if not drilled(part):
        return None
    tool, deepest = number_text(part.radius[0]), number_text(part.height.max())
    safe = number_text(options.safe_height)
    lines = [
        f"(metafem: {part.count} holes, ball-end mill of radius {tool} mm, deepest hole {deepest} mm, "
        "dwell P in seconds; check this program on the machine before use)",
        *("G21", "G90", "G54", f"S{options.spindle:g} M3", f"G0 Z{safe}"),
    ]
    for (x, y), depth in zip(mirrored(part.position), part.height, strict=True):
        lines += [f"G0 X{number_text(x)} Y{number_text(y)}", f"G1 Z{number_text(-depth)} F{options.feed:g}"]
        lines += [f"G4 P{options.dwell:g}"] if options.dwell > 0.0 else []
        lines.append(f"G0 Z{safe}")
    return "\n".join([*lines, "M5", "M30"]) + "\n"


def drilled(part: Surface) -> bool:
    """Return whether one ball-end mill makes all holes."""
    return part.cap == SPHERE and float(np.ptp(part.radius)) == 0.0


def number_text(value: float) -> str:
    """Return a length [mm] as text with `DECIMALS` decimals.

    Examples
    --------
    >>> number_text(0.1 + 0.047), number_text(-0.0)
    ('0.14700', '0.00000')
    """
    return f"{round(float(value), DECIMALS) + 0.0:.{DECIMALS}f}"


def _head(design: Design, part: Surface) -> Iterator[str]:
    """Yield what a workshop must know beside the holes."""
    yield "Holes of the mould in mm, seen from its open face, as on the machine; the part is mirrored."
    yield "Origin: centre of the block, in the face of the mould. Depths are measured down from the face."
    if design.surface.block is not None:
        block = design.surface.block
        thickness = block.thickness + float(part.height.max())
        yield (
            f"Casting: {block.width:g} by {block.length:g} mm inside the frame, {block.thickness:g} mm above "
            f"the face; mould.stl is {thickness:g} mm thick."
        )
    if design.limits.height_sd:
        sd = MICROMETRES * design.limits.height_sd
        yield f"Tolerance: standard deviation of the depths at most {sd:g} um, as the specification states."
