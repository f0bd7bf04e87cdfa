"""Interaction by point loads and to third order against resolved contacts.

Resolved contacts are pressures on cells, without a law for a single contact. Loads and areas on several cells
are extrapolated to vanishing ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

import metafem as mf
from metafem.drawing import QUIET
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods import point_load_error
from validation.scenes.close_contacts import CROWDED, PITCH, Scene, crowded, irregular, lattice
from validation.scenes.models import CAP_ERROR, CAP_LOAD_ERROR, FEW_ERROR, LOAD_ERROR
from validation.sources import second_method

# The tests of this claim carry the mark "slow".
SLOW = True

# Approaches [mm] of the 3 x 3 lattice: contact radii from 0.10 to 0.22 of the pitch.
APPROACHES = (0.05, 0.1, 0.15, 0.2, 0.3)

# Nine crowded contacts at the ends of the documented ranges.
SHAPES = {
    "paraboloid": mf.Hertz(),
    "sphere": mf.Elastic(mf.Sphere()),
    "power 3": mf.Elastic(mf.Power(3.0)),
    "power 4": mf.Elastic(mf.Power(4.0)),
}

# Cells per contact radius. Errors fall as the inverse square; those of neighbouring cells scatter, and the
# scatter of four about the line is the uncertainty of the extrapolated value.
CELLS = np.array([24.0, 32.0, 42.0, 56.0])

# The next terms of the expansion are (a/r)² of the leading ones: 6 % at a/r = 0.24.
NEXT = 0.06

RESOLVED = second_method(mf.BoundaryElements, "resolved contacts, extrapolated to vanishing cells")
LEADING = second_method(point_load_error.area_error, "curvature of the field of point loads")


class Errors(NamedTuple):
    """Relative errors of load at fixed approach and of A0 at fixed load, and the uncertainty of each (2,).

    radius: contact radii [mm]; leading: the closed form of the error of point loads.
    """

    load: float
    area: float
    uncertain: np.ndarray
    radius: np.ndarray
    leading: float


@cache
def scenes() -> dict[str, Scene]:
    """Return the scenes in the order of the report."""
    return {
        **{f"3 x 3, approach {1e3 * d:g} µm": lattice(d) for d in APPROACHES},
        "3 x 3 on the layer, approach 200 µm": lattice(0.2, substrate=mf.BondedLayer()),
        "six unequal asperities": irregular(),
        **{f"3 x 3, a/r = {CROWDED:g}, {shape}": crowded(law) for shape, law in SHAPES.items()},
    }


@cache
def truth(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return load [N] and A0 [mm²] of resolved contacts without cells, and their relative uncertainties."""
    scene = scenes()[name]
    widest = np.sqrt(scene.state(scene.expansion(3)).asperity_area.max() / np.pi)
    models = (mf.BoundaryElements(widest / cells, scene.substrate, scene.contact) for cells in CELLS)
    values = np.array([(each.load, each.area) for each in map(scene.state, models)])
    terms = np.column_stack([np.ones(len(CELLS)), CELLS**-2.0])
    line, squares, *_ = np.linalg.lstsq(terms, values / values[-1], rcond=None)
    return line[0] * values[-1], np.sqrt(squares / (len(CELLS) - 2))


@cache
def errors(name: str, order: int) -> Errors:
    """Return the errors of an order on a scene."""
    scene, (value, uncertain) = scenes()[name], truth(name)
    model = scene.expansion(order)
    under = scene.state(model, load=float(value[0]))
    radius = np.sqrt(under.asperity_area / np.pi)
    apart = np.linalg.norm(scene.surface.position[:, None] - scene.surface.position, axis=2)
    load, area = scene.state(model).load / value[0] - 1.0, under.area / value[1] - 1.0
    return Errors(load, area, uncertain, radius, point_load_error.area_error(radius, apart))


def claim() -> Claim:
    """Order 1 represents the neighbours of a contact by point loads, as the paper does; order 3 adds the size
    of the contacts and the curvature and slope of their fields. Resolved contacts assume nothing of this. The
    error of order 1 in A0 grows as the cube of contact radius over distance and reaches half a percent, as
    much as interaction itself changes A0(P) of some of the paper's surfaces. Order 3 is the default. Its
    error for crowded spheres and power caps is about that of paraboloids.
    """
    rows = [row for name in scenes() for row in _scene(name)]
    figures = {"errors": Picture(_figure)}
    return Claim("Interaction to third order against resolved contacts", [*rows, *_leading()], figures)


def _scene(name: str) -> Iterator[Row]:
    """Compare order 3 with the stated errors."""
    third = errors(name, 3)
    caps = any(name.endswith(shape) for shape in list(SHAPES)[1:])
    load, area = (CAP_LOAD_ERROR, CAP_ERROR) if caps else (LOAD_ERROR, FEW_ERROR)
    yield below(f"{name}, order 3: error of the load", abs(third.load), load, RESOLVED)
    yield below(f"{name}, order 3: error of A0", abs(third.area), area, RESOLVED)
    unsure = f"{RESOLVED}; uncertainty {1e2 * third.uncertain[1]:.2g} %"
    yield reported(f"{name}, order 1: error of A0 [%]", 1e2 * errors(name, 1).area, unsure)


def _leading() -> Iterator[Row]:
    """Compare the error of order 1, which grows as (a/r)³, with its closed form."""
    for name in list(scenes())[: len(APPROACHES)]:
        ratio = errors(name, 1).area / errors(name, 1).leading
        yield near(f"{name}, order 1: error of A0 over its leading term", ratio, 1.0, NEXT, LEADING)


@panels(7.0, 4.0)
def _figure(ax):
    """Relative error of A0 at a given load on the 3 x 3 lattice. Order 1 (circles) follows the line, the
    closed form of its leading error with slope 3; order 3 (squares) is far below it. The bars are the
    uncertainty of the resolved contacts.
    """
    names = list(scenes())[: len(APPROACHES)]
    first, third = ([errors(name, order) for name in names] for order in (1, 3))
    ratio = [each.radius.mean() / PITCH for each in first]
    ax.plot(ratio, [1e2 * each.leading for each in first], color=QUIET, label="leading error, slope 3")
    for found, mark, label in ((first, "o", "order 1"), (third, "s", "order 3")):
        area, bar = 1e2 * np.abs([(each.area, each.uncertain[1]) for each in found]).T
        # a bar to zero has no end on a logarithmic axis
        ax.errorbar(ratio, area, [np.minimum(bar, 0.9 * area), bar], fmt=mark, label=label)
    ax.loglog()
    ax.set(xlabel="contact radius over pitch  a/L", ylabel="error of A0 at a given load [%]")
