"""Notes on how the summits of a map belong to the sites of a design."""

from __future__ import annotations

import math

from metafem._given import formatted, label
from metafem._validate import FloatArray, IntArray
from metafem._values import percent
from metafem.calibration.topography.alignment import Alignment
from metafem.notes import Note, information
from metafem.surface import Surface

# Largest relative error of distances on the map that is not noted; microscopes are calibrated to this.
SCALE = 2e-3

# A standard deviation of the height errors above this part of that of the designed heights and this part of
# their mean is noted: errors of making are a few percent, those of another part as large as its heights.
FOREIGN, FOREIGN_MEAN = 0.5, 0.05

# Places of a kind that are named one by one.
NAMED = 5

UNDECIDED = "the heights do not tell how the part was turned, mirrored or shifted; it is taken as it lies"


def placement_notes(
    design: Surface, centre: FloatArray, place: Alignment, missing: IntArray, other: list[tuple[float, float]]
) -> list[Note]:
    """Return what has no site, what is missing, and how the part was turned, mirrored or scaled."""
    apart = [on_map(*each) for each in centre[place.site < 0].tolist()]
    notes = _named(
        "cap", apart, "on the map has no site in the design", "on the map have no site in the design"
    )
    hills = [on_map(*each) for each in other]
    notes += _named(
        "hill", hills, "on the map is no cap of the design", "on the map are no caps of the design"
    )
    for i in missing[:NAMED]:
        notes.append(
            Note(f"asperity {i} of the design, at {on_map(*design.position[i])}, is missing on the map")
        )
    if len(missing) > NAMED:
        numbers = ", ".join(map(str, missing[NAMED:]))
        notes.append(Note(f"so are {len(missing) - NAMED} others of the design: {numbers}"))
    height = design.height[place.site[place.site >= 0]]
    if place.misfit > FOREIGN * height.std() and place.misfit > FOREIGN_MEAN * height.mean():
        error, designed = (formatted("height", float(value)) for value in (place.misfit, height.std()))
        notes.append(
            Note(
                f"the heights of the caps are not those of the design: their errors have the standard "
                f"deviation {error} mm, the designed heights {designed} mm; check the design, and whether "
                "the map shows the mould"
            )
        )
    turn = round(math.degrees(place.rotation) / 90.0) % 4 * 90
    if not place.decided:
        notes.append(information(UNDECIDED))
    elif turn or place.mirrored:
        ways = [f"turned by {turn} degrees"] * bool(turn) + ["mirrored"] * place.mirrored
        notes.append(information(f"by its heights, the part is {' and '.join(ways)} on the map"))
    if abs(place.scale - 1.0) > SCALE:
        larger = percent(place.scale - 1.0, "+.2g")
        notes.append(Note(f"distances on the map differ from the design's by {larger}; check pixel_size"))
    return notes


def _named(what: str, places: list[str], one: str, many: str) -> list[Note]:
    """Return a note for each of a few places, and the number of the others."""
    notes = [Note(f"the {what} at {place} {one}") for place in places[:NAMED]]
    if len(places) > NAMED:
        notes.append(Note(f"{len(places) - NAMED} other {what}s {many}"))
    return notes


def on_map(x: float, y: float) -> str:
    """Return a point of a map for a note."""
    return f"({x:.3f}, {y:.3f}) mm"


def no_cap(radius: float, hills: int, mould: bool) -> str:
    """Return the error for a map on which no hill is a cap of about this radius [mm]."""
    other = "1 hill of another shape" if hills == 1 else f"{hills} hills of other shapes"
    return (
        f"{label('height_map')} shows no cap of a radius near {radius:g} mm, but {other}; check "
        f"{label('pixel_size')}, {label('the unit of the heights')} and {label(f'mould={not mould}')}"
    )
