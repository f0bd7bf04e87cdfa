"""Order 3 for caps that are no paraboloids against resolved contacts, and these against single contacts.

The quartic cap, and the sphere whose largest contact has a/R = 0.5, on a half-space: a lattice of 3 x 3 equal
heights, and two scenes of six unequal asperities. L is the smallest distance of two asperities, a the radius
of the largest contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import brentq

import metafem as mf
from metafem.caps.shapes import sphere_profile
from metafem.contact import Contact
from validation.benchmark import automatic
from validation.timing import Row

# Cells per radius of the largest contact; with 50 the error of one contact is below 1e-4 in load and area.
CELLS = 60
CELLS_OF_ONE = 50

# a/L of the scenes; largest errors of A0 at fixed load up to two of them, and of the load at fixed approach.
RATIOS = (0.1, 0.15, 0.2, 0.235, 0.27, 0.31)
AREA_ERROR = {0.2: 3e-4, 0.27: 7e-4, 0.31: 1.2e-3}
LOAD_ERROR = 4e-4

# Random surfaces on which Automatic is compared.
SURFACES = 30

# Largest error of load and area of one resolved contact.
ONE_ERROR = 3e-4

RADIUS, PITCH = 0.526, 1.5
MATERIAL = mf.Material(1.36)

# Six unequal asperities: the first scene is that of the source of the numbers for paraboloids.
PLACES = (
    [[0.1, 0.2], [1.4, -0.3], [-0.2, 1.9], [1.7, 1.5], [3.3, 0.4], [2.9, 2.6]],
    [[0.0, 0.0], [1.2, 0.1], [0.5, 1.2], [2.0, 1.1], [3.1, -0.2], [1.3, 2.5]],
)
BELOW = np.array([0.01, 0.0, 0.008, 0.004, 0.002, 0.009])
SIZES = np.array([0.95, 1.14, 0.76, 1.0, 0.86, 1.33])


def irregular(place: list[list[float]], radius: float) -> mf.Surface:
    """Return six unequal asperities."""
    return mf.Surface(place, 0.5 - BELOW, radius * SIZES, MATERIAL)


# Surfaces of a radius [mm].
SCENES: dict[str, Callable[[float], mf.Surface]] = {
    "3 x 3": lambda radius: mf.Surface.square_lattice(0.5, (3, 3), PITCH, radius=radius, material=MATERIAL),
    "six unequal": partial(irregular, PLACES[0]),
    "six closer": partial(irregular, PLACES[1]),
}

# Laws, and the radius of a cap whose contact has a radius: results of the quartic cap do not depend on it.
LAWS: dict[str, tuple[Contact, Callable[[float], float]]] = {
    "quartic cap": (mf.PowerCap(4), lambda contact_radius: RADIUS),
    "sphere, a/R = .5": (mf.SphericalCap(), lambda contact_radius: 2.0 * contact_radius),
}


def errors(law: Contact, surface: mf.Surface, contact_radius: float) -> tuple[float, float]:
    """Return the relative errors of the load at fixed approach, and of A0 at fixed load.

    The approach is that at which the largest contact by order 3 has the radius [mm].
    """
    model = mf.Interacting(contact=law)

    def excess(approach: float) -> float:
        widest = mf.equilibrium(surface, model, approach=approach).asperity_area.max()
        return math.sqrt(widest / math.pi) - contact_radius

    alone = float(law.indentation(contact_radius, float(np.max(surface.radius))))
    approach = brentq(excess, 0.2 * alone, 5.0 * alone, rtol=1e-4)
    resolved = mf.BoundaryElements(contact_radius / CELLS, contact=law)
    exact = mf.equilibrium(surface, resolved, approach=approach)
    load = mf.equilibrium(surface, model, approach=approach).load / exact.load - 1.0
    state = mf.equilibrium(surface, model, load=exact.load)
    return load, state.area / exact.area - 1.0


def one_contact(law: Contact, radius: float, contact_radius: float) -> tuple[float, float]:
    """Return the relative errors of load and area of one resolved contact, off the middle of its cell."""
    cell = contact_radius / CELLS_OF_ONE
    place = [[0.0, 0.0], [200.6 * cell, 0.2 * cell]]  # a low summit moves the middle of the grid
    surface = mf.Surface(place, [0.0, -10.0], radius, MATERIAL)
    approach = float(law.indentation(contact_radius, radius))
    state = mf.equilibrium(surface, mf.BoundaryElements(cell, contact=law), approach=approach)
    load = MATERIAL.composite_modulus * float(law.load(contact_radius, radius))
    return state.load / load - 1.0, state.area / float(law.area(contact_radius)) - 1.0


def rows() -> Iterator[Row]:
    """Measure one contact of each law, and order 3 on every scene."""
    rho = np.linspace(0.0, 0.45, 80)
    table = mf.AxisymmetricCap([rho, sphere_profile(rho, RADIUS)])
    ones: dict[str, tuple[Contact, float]] = {
        "quartic cap": (mf.PowerCap(4), 0.2),
        "sphere, a/R = .5": (mf.SphericalCap(), 0.5 * RADIUS),
        "table of the sphere": (table, 0.5 * RADIUS),
    }
    for name, (law, contact_radius) in ones.items():
        found = np.abs(one_contact(law, RADIUS, contact_radius)).max()
        yield Row(f"one resolved contact, {name}: load and area", ONE_ERROR, found)
    for name, (law, radius_of) in LAWS.items():
        for where, scene in SCENES.items():
            x = scene(RADIUS).position
            apart = float(np.linalg.norm(x[:, None] - x, axis=-1)[np.triu_indices(len(x), 1)].min())
            wide = [ratio * apart for ratio in RATIOS]
            load, area = np.abs([errors(law, scene(radius_of(a)), a) for a in wide]).T
            what = f"order 3, {name}, {where}"
            yield Row(f"{what}: load, a/L <= {RATIOS[-1]:g}", LOAD_ERROR, load.max())
            for most, required in AREA_ERROR.items():
                yield Row(f"{what}: A0, a/L <= {most:g}", required, area[np.array(RATIOS) <= most].max())


def long_rows() -> Iterator[Row]:
    """Compare Automatic with resolved contacts, extrapolated to vanishing cells, on random surfaces."""
    for name, law in (("quartic cap", mf.PowerCap(4)), ("sphere", mf.SphericalCap())):
        with ProcessPoolExecutor() as processes:
            found = list(processes.map(partial(automatic.error_and_uncertainty, law=law), range(SURFACES)))
        yield from (replace(row, what=f"{name}, {row.what}") for row in automatic.summary(found))
