"""Scenes at which the maps of stability compare order 3 and Automatic with resolved contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem.models.error import truncation
from metafem.notes import Level
from metafem.substrate import Radial
from validation.methods.resolved_areas import extrapolated_area

# The pitch is the unit of length. The contacts are paraboloids, for which R only scales the heights.
PITCH, RADIUS = 1.0, 10.0

# Contact radius of the tallest asperity without interaction over the pitch; from 0.5 on contacts merge. The
# tests take fewer.
WIDTHS = (0.1, 0.2, 0.3, 0.36, 0.44, 0.54)

# Spread of the heights over the indentation of the tallest, and the rank of each height on the lattice.
SPREADS = (0.0, 0.5, 2.0)
RANKS = np.array([0, 5, 2, 7, 4, 1, 8, 3, 6]) / 8.0

# Contact radius over the thickness of a layer, and Poisson's ratios.
LAYERS = (0.1, 0.3, 0.5, 0.8, 1.5)
RATIOS = (0.0, 0.3, 0.5)

# Ratios of the radii of two asperities.
RADII = (1.0, 2.0, 5.0, 10.0)

# Asperities on a side of the lattice of equal contacts, their radius without interaction over the pitch,
# near the largest ratio to which order 3 was compared, cells per contact radius, and steps to equal contacts.
SIDE, WIDE, FEWER_CELLS, STEPS = 8, 0.319, 14, 12

# Largest ratio of contact radius to the distance of neighbours at which order 3 was compared with resolved
# contacts.
COMPARED = 0.32

# Tolerance of `Automatic` and of the reference [-]; cells per contact radius and their number in the latter.
TOLERANCE = 1e-3
CELLS, SIZES = 32, (5, 7)


@dataclass(frozen=True)
class Point:
    """One scene: relative errors of A0, nan where there is no solution, and what Automatic chose."""

    third: float  # error of order 3
    automatic: float
    uncertainty: float
    estimate: float  # that of the error of order 3, infinite where contacts overlap
    ratio: float  # contact radius over the distance of neighbours, or over the thickness of the layer
    warned: bool  # whether order 3 has a warning
    resolved: bool  # whether Automatic chose resolved contacts
    refusal: str  # the words with which order 3 refuses


def solve(surface: mf.Surface, load: float, substrate: Radial, apart: float, cells: int = CELLS) -> Point:
    """Solve a scene by order 3 and by Automatic and compare both with resolved contacts."""
    third, estimate, warned, refusal = math.nan, math.inf, False, ""
    model = mf.Interacting(3, substrate)
    try:
        point = mf.equilibrium(surface, model, load=load)
        third, estimate = point.area, truncation(surface, point.asperity_area, substrate)
        warned = any(note.level is Level.WARNING for note in point.notes)
    except mf.MetafemError as error:
        refusal = str(error)
    state = mf.equilibrium(surface, mf.Automatic(TOLERANCE, substrate), load=load)
    options = {"substrate": substrate, "first": cells, "sizes": SIZES}
    exact, uncertainty = extrapolated_area(surface, load, TOLERANCE / 3.0, **options)
    ratio = float(np.sqrt(state.asperity_area.max() / math.pi)) / apart
    resolved = isinstance(state.model, mf.BoundaryElements)
    errors = third / exact - 1.0, state.area / exact - 1.0, uncertainty, estimate
    return Point(*errors, ratio, warned, resolved, refusal)


def alone(surface: mf.Surface, approach: float) -> float:
    """Return the load [N] of contacts without interaction at an approach."""
    return mf.equilibrium(surface, approach=approach).load


@cache
def crowded(width: float, spread: float) -> Point:
    """Nine asperities whose tallest has a contact of a given width without interaction."""
    depth = (width * PITCH) ** 2 / RADIUS
    height = 2.0 * RADIUS - spread * depth * RANKS
    surface = mf.Surface.square_lattice(height, (3, 3), PITCH, radius=RADIUS, material=mf.Material(1.0))
    return solve(surface, alone(surface, depth), mf.HalfSpace(), PITCH)


@cache
def equal() -> Point:
    """A lattice whose heights make all contacts equal: the sum over the neighbours is largest there."""
    size = SIDE, SIDE
    surface = mf.Surface.square_lattice(2.0 * RADIUS, size, PITCH, radius=RADIUS, material=mf.Material(1.0))
    load = surface.count * 4.0 / 3.0 * (WIDE * PITCH) ** 3 / RADIUS
    for _ in range(STEPS):
        state = mf.equilibrium(surface, mf.Interacting(), load=load)
        square = state.asperity_area / math.pi
        surface = surface.replaced(height=surface.height + ((WIDE * PITCH) ** 2 - square) / RADIUS)
    return solve(surface, load, mf.HalfSpace(), PITCH, FEWER_CELLS)


@cache
def on_layer(width: float, poisson_ratio: float) -> Point:
    """One contact of a given width on a layer of thickness 1."""
    material, block = mf.Material(1.0, poisson_ratio), mf.Block(50.0, 50.0, 1.0)
    surface = mf.Surface([[0.0, 0.0]], [1.0], RADIUS, material, block=block)
    return solve(surface, alone(surface, width**2 / RADIUS), mf.BondedLayer(), 1.0)


@cache
def unequal(ratio: float) -> Point:
    """A large and a small asperity with equal indentations."""
    depth = 0.2**2 / RADIUS
    surface = mf.Surface([[0.0, 0.0], [1.0, 0.0]], [1.0, 1.0], [RADIUS, RADIUS / ratio], mf.Material(1.0))
    return solve(surface, alone(surface, depth), mf.HalfSpace(), 1.0)
