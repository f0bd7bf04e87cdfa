"""Where order 3 holds, where contacts are resolved, and where there is a refusal: maps over the scenes.

The errors are those of A0 at a given load against resolved contacts without cells, of the same scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

import metafem as mf
from metafem.models.error import truncation
from metafem.notes import Level
from metafem.prediction.validity import BOUND
from metafem.substrate import Radial
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods.resolved_areas import extrapolated_area
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

# Asperities on a side of the lattice of equal contacts, their radius over the pitch, cells per contact
# radius, and steps to equal contacts.
SIDE, WIDE, FEWER_CELLS, STEPS = 8, 0.319, 14, 12

# Largest ratio of contact radius to the distance of neighbours, and to the thickness, of the stated errors.
COMPARED, THIN = 0.32, 0.3

# Tolerance of `Automatic` and of the reference [-]; cells per contact radius and their number in the latter.
TOLERANCE, CELLS, SIZES = 1e-3, 32, (5, 7)

# Error from which it is compared with its estimate, as smaller ones are uncertain, and the margin of the
# estimate over the errors that were seen: the quarter of `metafem.models.error`.
CERTAIN, MARGIN = 0.2 * TOLERANCE, 1.25

# Ends of the colours of the map [%].
LIMITS = (0.001, 1.0)

RESOLVED = self_consistency(extrapolated_area, "resolved contacts, extrapolated to vanishing cells")
ANNOUNCED = known_input(f"requirement: an error above {100 * BOUND:g} % is announced by a warning")


class Point(NamedTuple):
    """One scene: relative errors of A0, nan where there is no solution, and what Automatic chose."""

    third: float  # error of order 3
    automatic: float
    uncertainty: float
    estimate: float  # that of the error of order 3, infinite where contacts overlap
    ratio: float  # contact radius over the distance of neighbours, or over the thickness of the layer
    announced: bool  # whether order 3 warns or refuses
    resolved: bool  # whether Automatic chose resolved contacts

    @property
    def beyond(self) -> float:
        """Size of the error of order 3 without the uncertainty of the resolved contacts, nan if refused."""
        return abs(self.third) - self.uncertainty


def solve(surface: mf.Surface, load: float, substrate: Radial, cells: int = CELLS) -> Point:
    """Solve a scene of unit distances by order 3 and by Automatic; compare both with resolved contacts."""
    third, estimate, announced = math.nan, math.inf, True
    try:
        point = mf.equilibrium(surface, mf.Interacting(3, substrate), load=load)
        third, estimate = point.area, truncation(surface, point.asperity_area, substrate)
        announced = any(note.level is Level.WARNING for note in point.notes)
    except mf.MetafemError:
        pass
    state = mf.equilibrium(surface, mf.Automatic(TOLERANCE, substrate), load=load)
    options = {"substrate": substrate, "first": cells, "sizes": SIZES}
    exact, uncertainty = extrapolated_area(surface, load, TOLERANCE / 3.0, **options)
    ratio = float(np.sqrt(state.asperity_area.max() / math.pi))
    errors = third / exact - 1.0, state.area / exact - 1.0, uncertainty, estimate
    return Point(*errors, ratio, announced, isinstance(state.model, mf.BoundaryElements))


def _pressed(surface: mf.Surface, depth: float, substrate: Radial) -> Point:
    """Solve a scene under the load of contacts without interaction at an approach."""
    return solve(surface, mf.equilibrium(surface, approach=depth).load, substrate)


@cache
def crowded(width: float, spread: float) -> Point:
    """Nine asperities whose tallest has a contact of a given width without interaction."""
    depth = width**2 / RADIUS
    height = 2.0 * RADIUS - spread * depth * RANKS
    surface = mf.Surface.square_lattice(height, (3, 3), 1.0, radius=RADIUS, material=mf.Material(1.0))
    return _pressed(surface, depth, mf.HalfSpace())


def equal() -> Point:
    """A lattice whose heights make all contacts equal: the sum over the neighbours is largest there."""
    part = {"radius": RADIUS, "material": mf.Material(1.0)}
    surface = mf.Surface.square_lattice(2.0 * RADIUS, (SIDE, SIDE), 1.0, **part)
    load = surface.count * 4.0 / 3.0 * WIDE**3 / RADIUS
    for _ in range(STEPS):
        square = mf.equilibrium(surface, mf.Interacting(), load=load).asperity_area / math.pi
        surface = surface.replaced(height=surface.height + (WIDE**2 - square) / RADIUS)
    return solve(surface, load, mf.HalfSpace(), FEWER_CELLS)


def on_layer(width: float, poisson_ratio: float) -> Point:
    """One contact of a given width on a layer of thickness 1."""
    material, block = mf.Material(1.0, poisson_ratio), mf.Block(50.0, 50.0, 1.0)
    surface = mf.Surface([[0.0, 0.0]], [1.0], RADIUS, material, block=block)
    return _pressed(surface, width**2 / RADIUS, mf.BondedLayer())


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
    nine = [crowded(width, spread) for spread in SPREADS for width in WIDTHS]
    layers = {(width, nu): on_layer(width, nu) for nu in POISSON for width in LAYERS}
    lattice = equal()
    every = [*nine, *layers.values(), lattice]
    worst = max(abs(each.automatic) - each.uncertainty for each in every)
    yield below(f"Automatic({TOLERANCE:g}): largest error of A0", worst, TOLERANCE, RESOLVED)
    worst = max(each.beyond for each in nine if each.ratio <= COMPARED)
    name = f"order 3 up to a/r = {COMPARED:g} on the half-space, nine contacts: error of A0"
    yield below(name, worst, FEW_ERROR, RESOLVED)
    name = f"order 3, {SIDE**2} equal contacts"
    yield below(f"{name} at a/r = {lattice.ratio:.2g}: error of A0", lattice.beyond, AREA_ERROR, RESOLVED)
    unsure = f"uncertainty {1e2 * lattice.uncertainty:.2g} %"
    yield reported(f"{name}: error of A0 [%]", 1e2 * lattice.third, unsure)
    worst = max(each.beyond for (width, _), each in layers.items() if width <= THIN)
    yield below(f"order 3 up to a/t = {THIN:g} on a layer: largest error of A0", worst, LAYER_ERROR, RESOLVED)
    over = [each.beyond / each.estimate for each in every if each.beyond > CERTAIN]
    words = f"of errors above {1e2 * CERTAIN:.2g} %"
    yield below(f"order 3: largest error of A0 over its estimate, {words}", max(over), 1.0 / MARGIN, RESOLVED)
    silent = sum(abs(each.third) > BOUND and not each.announced for each in every)
    name = f"order 3: scenes with an error above {100 * BOUND:g} % and no warning"
    yield near(name, silent, 0, 0, ANNOUNCED)
    chosen = sum(each.resolved for each in every)
    yield reported("scenes in which Automatic chose resolved contacts", chosen, f"of {len(every)}")


@panels(6.0, 3.6)
def _figure(ax):
    """Error of A0 by order 3 for nine contacts on a half-space; a/L is the radius of the tallest contact
    without interaction over the pitch of the lattice, and the spread of the heights is that over the
    indentation of the tallest. Errors below 0.001 % are shown as 0.001 %. A: Automatic takes an asperity
    model; R: it resolves the contacts, also where they merge (a/L above 0.5).
    """
    rows = [[crowded(width, spread) for width in WIDTHS] for spread in SPREADS]
    third = np.maximum(1e2 * np.abs([[each.third for each in row] for row in rows]), LIMITS[0])
    style = {"cmap": "viridis", "norm": "log", "vmin": LIMITS[0], "vmax": LIMITS[1], "edgecolors": "white"}
    drawn = ax.pcolormesh(third, **style)
    for (i, j), error in np.ndenumerate(third):
        mark, colour = "R" if rows[i][j].resolved else "A", "black" if error > 0.1 else "white"
        text = f"{error:.2g} %\n{mark}"
        ax.text(j + 0.5, i + 0.5, text, ha="center", va="center", fontsize=7, color=colour)
    ax.set_xticks(np.arange(len(WIDTHS)) + 0.5, [f"{width:g}" for width in WIDTHS])
    ax.set_yticks(np.arange(len(SPREADS)) + 0.5, [f"{spread:g}" for spread in SPREADS])
    ax.set(xlabel="a/L", ylabel="spread of the heights over the indentation")
    ax.figure.colorbar(drawn, ax=ax, label="error of order 3 [%]", extend="max")
