"""Where order 3 holds, where contacts are resolved, and where there is a refusal: maps over the scenes.

The errors are those of A0 at a given load against resolved contacts without cells, of the same scene.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from itertools import product

import numpy as np
import pandas as pd

import metafem as mf
from metafem.models.error import truncation
from metafem.notes import Level
from metafem.prediction.validity import BOUND
from metafem.substrate import Radial
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods.resolved_areas import extrapolated_area
from validation.scenes.close_contacts import CROWDED, equal_contacts, unit_lattice
from validation.scenes.models import AREA_ERROR, FEW_ERROR, LAYER_ERROR
from validation.sources import known_input, self_consistency

# Half a minute of one core.
SLOW = True

# The pitch is the unit of length. The contacts are paraboloids, for which R only scales the heights.
RADIUS = 10.0

# Contact radius of the tallest asperity without interaction over the pitch; from 0.5 on contacts merge.
# Spread of the heights over the indentation of the tallest, and the rank of each height on the lattice.
WIDTHS, SPREADS = (0.1, 0.2, 0.3, 0.36, 0.44, 0.54), (0.0, 0.5, 2.0)
RANKS = np.array([0, 5, 2, 7, 4, 1, 8, 3, 6]) / 8.0

# Contact radius over the thickness of a layer, and Poisson's ratios.
LAYERS, POISSON = (0.1, 0.3, 0.8, 1.5), (0.0, 0.3, 0.5)

# Asperities on a side of the lattice of equal contacts, and cells per contact radius.
SIDE, FEWER_CELLS = 8, 14

# Largest ratio of contact radius to the distance of neighbours, and to the thickness, of the stated errors.
COMPARED, THIN = 0.32, 0.3

# Tolerance of `Automatic` and of the reference [-]; cells per contact radius and their number in the latter.
TOLERANCE, CELLS, SIZES = 1e-3, 32, (5, 7)

# Error from which it is compared with its estimate, as smaller ones are uncertain, and the margin of the
# estimate over the errors that were seen: the quarter of `metafem.models.error`.
CERTAIN, MARGIN = 0.2 * TOLERANCE, 1.25

# What the warnings of order 3 on wide contacts are about; others concern the heights.
WIDE = ("error of order 3", "overlapping pairs of contacts")

# Ends of the colours of the map [%].
LIMITS = (0.001, 1.0)

RESOLVED = self_consistency(extrapolated_area, "resolved contacts, extrapolated to vanishing cells")
ANNOUNCED = known_input(f"requirement: an error above {100 * BOUND:g} % is announced by a warning")


def solve(surface: mf.Surface, substrate: Radial, cells: int = CELLS, **given: float) -> dict[str, float]:
    """Solve a scene of unit distances by order 3 and by Automatic; compare both with resolved contacts.

    It is solved under a load, or under that of contacts without interaction at an approach. third: relative
    error of A0 by order 3, nan where there is no solution; automatic: size of that of Automatic; estimate:
    that of the error of order 3, infinite where contacts overlap; ratio: contact radius over the distance of
    neighbours, or over the thickness of the layer; announced: whether order 3 warns of wide contacts or
    refuses; resolved: whether Automatic resolves them. The errors include that of the reference.
    """
    load = mf.equilibrium(surface, **given).load
    area, estimate, announced = np.nan, np.inf, True
    with suppress(mf.MetafemError):
        point = mf.equilibrium(surface, mf.Interacting(3, substrate), load=load)
        area, estimate = point.area, truncation(surface, point.asperity_area, substrate)
        announced = any(note.level is Level.WARNING and note.quantity in WIDE for note in point.notes)
    state = mf.equilibrium(surface, mf.Automatic(TOLERANCE, substrate), load=load)
    options = {"substrate": substrate, "first": cells, "sizes": SIZES}
    exact, uncertainty = extrapolated_area(surface, load, TOLERANCE / 3.0, **options)
    return {
        "third": area / exact - 1.0, "uncertainty": uncertainty, "estimate": estimate, "announced": announced,
        "automatic": abs(state.area / exact - 1.0), "resolved": isinstance(state.model, mf.BoundaryElements),
        "ratio": float(np.sqrt(state.asperity_area.max() / np.pi)),
    }  # fmt: skip


def crowded(spread: float, width: float) -> dict[str, float]:
    """Nine asperities whose tallest has a contact of a given width without interaction."""
    depth = width**2 / RADIUS
    surface = unit_lattice(2.0 * RADIUS - spread * depth * RANKS, 3, RADIUS)
    return solve(surface, mf.HalfSpace(), approach=depth)


def on_layer(poisson_ratio: float, width: float) -> dict[str, float]:
    """One contact of a given width on a layer of thickness 1."""
    material, block = mf.Material(1.0, poisson_ratio), mf.Block(50.0, 50.0, 1.0)
    surface = mf.Surface([[0.0, 0.0]], [1.0], RADIUS, material, block=block)
    return solve(surface, mf.BondedLayer(), approach=width**2 / RADIUS)


@cache
def scenes() -> pd.DataFrame:
    """Return the solved scenes by their kind, spread of the heights or Poisson's ratio, and width."""
    solved = {("nine", *at): crowded(*at) for at in product(SPREADS, WIDTHS)}
    solved |= {("layer", *at): on_layer(*at) for at in product(POISSON, LAYERS)}
    surface, load = equal_contacts(SIDE, RADIUS)
    solved["equal", 0.0, CROWDED] = solve(surface, mf.HalfSpace(), FEWER_CELLS, load=load)
    return pd.DataFrame(solved.values(), pd.MultiIndex.from_tuples(solved, names=("kind", "", "width")))


def claim() -> Claim:
    """Order 3 holds while contacts are narrow compared with their distances and with the thickness of a
    layer. Automatic estimates the errors of independent asperities and of order 3 from their contacts, takes
    the first within the tolerance, and resolves the contacts by cells where none is, where contacts overlap,
    and where order 3 refuses. Errors are those of A0 at a given load. Order 3 warns where contacts overlap
    and where its estimated error exceeds {bound:g} %. For a smaller tolerance use Automatic.
    """
    figures, values = {"crowded contacts": Picture(_figure)}, {"bound": 100.0 * BOUND}
    return Claim("Where order 3 holds, and what Automatic chooses", [*_rows()], figures, values)


def _rows() -> Iterator[Row]:
    """Compare the errors with those that the models state."""
    every, size = scenes(), scenes().third.abs()
    nine, layer, lattice = every.loc["nine"], every.loc["layer"], every.loc["equal"].iloc[0]
    name = f"order 3, {SIDE**2} equal contacts"
    for words, errors, limit in (
        (f"Automatic({TOLERANCE:g}): largest error of A0", every.automatic, TOLERANCE),
        (f"order 3 up to a/r = {COMPARED:g} on the half-space, nine contacts: error of A0",
         size["nine"][nine.ratio <= COMPARED], FEW_ERROR),
        (f"{name} at a/r = {lattice.ratio:.2g}: error of A0", size["equal"], AREA_ERROR),
        (f"order 3 up to a/t = {THIN:g} on a layer: largest error of A0",
         size["layer"][layer.index.get_level_values("width") <= THIN], LAYER_ERROR),
        (f"order 3: largest error of A0 over its estimate, of errors above {1e2 * CERTAIN:.2g} %",
         (size / every.estimate)[size > CERTAIN + every.uncertainty], 1.0 / MARGIN),
    ):  # fmt: skip
        yield below(words, errors.max(skipna=False), limit, RESOLVED)
    unsure = f"uncertainty {1e2 * lattice.uncertainty:.2g} %"
    yield reported(f"{name}: error of A0 [%]", 1e2 * lattice.third, unsure)
    far, name = size > BOUND, f"order 3: scenes with an error above {100 * BOUND:g} %"
    yield near(f"{name} and no warning", (far & ~every.announced).sum(), 0, 0, ANNOUNCED)
    yield reported(name, far.sum(), f"of {len(every)}")
    name = "scenes in which Automatic chose resolved contacts"
    yield reported(name, every.resolved.sum(), f"of {len(every)}")


@panels(6.0, 3.6)
def _figure(ax):
    """Error of A0 by order 3 for nine contacts on a half-space; a/L is the radius of the tallest contact
    without interaction over the pitch of the lattice, and the spread of the heights is that over the
    indentation of the tallest. Errors below 0.001 % are shown as 0.001 %. A: Automatic takes an asperity
    model; R: it resolves the contacts, also where they merge (a/L above 0.5).
    """
    nine = scenes().loc["nine"].unstack()
    third = np.maximum(1e2 * nine.third.abs().to_numpy(), LIMITS[0])
    style = {"cmap": "viridis", "norm": "log", "vmin": LIMITS[0], "vmax": LIMITS[1], "edgecolors": "white"}
    drawn = ax.pcolormesh(third, **style)
    for (i, j), error in np.ndenumerate(third):
        mark, colour = "R" if nine.resolved.iloc[i, j] else "A", "black" if error > 0.1 else "white"
        place = j + 0.5, i + 0.5, f"{error:.2g} %\n{mark}"
        ax.text(*place, ha="center", va="center", fontsize=7, color=colour)
    ax.set_xticks(np.arange(len(WIDTHS)) + 0.5, [f"{width:g}" for width in WIDTHS])
    ax.set_yticks(np.arange(len(SPREADS)) + 0.5, [f"{spread:g}" for spread in SPREADS])
    ax.set(xlabel="a/L", ylabel="spread of the heights over the indentation")
    ax.figure.colorbar(drawn, ax=ax, label="error of order 3 [%]", extend="max")
