"""Hertz's contact by high-order elements and by an active set on an ordinary mesh."""

from __future__ import annotations

from functools import cache

import numpy as np

from metafem import reference
from metafem.fe import press
from metafem.fe.elements import Body
from metafem.fe.geometry import Oblate, half_space_mesh
from metafem.fe.prescribed_radius import HALF_SPACE, pressed
from validation.check import Claim, Picture, above, below, near
from validation.figures import panels
from validation.finite_elements.active_set import search_contact
from validation.finite_elements.frozen_meshes import RADIUS
from validation.sources import closed_form, known_input, second_method

# Several seconds of finite elements.
SLOW = True

A = 0.2

# Largest relative error of a contact on the half-space.
LIMIT = 1e-6

# Poisson's ratio of a compressible half-space, degrees of the elements, and cells of the active set over the
# contact radius, with which the edge always has the same position within its cell.
OTHER, DEGREES, CELLS = 0.3, np.array([4, 5, 6, 7, 8]), 1.0 / np.array([10.3, 20.3, 40.3])

HERTZ = closed_form(reference.hertz, "Hertz (1882), doi:10.1515/crll.1882.92.156")
SNEDDON = closed_form(reference.power_law, "Sneddon (1965), doi:10.1016/0020-7225(65)90019-4")
COARSER = second_method(press, "the same with elements of a lower degree and larger at the edge")
EXPONENTIAL = known_input("theory: the error falls by a constant factor with each degree")
FIRST_ORDER = known_input("theory: order 1, as the edge of the contact is known to one cell")


def claim() -> Claim:
    """A paraboloid of R = 526 µm is pressed on a half-space by two finite element methods: high-order
    elements with the contact radius prescribed, in coordinates that remove the singularity at the edge, and
    an active set on ordinary quadratic elements. Load, indentation and displacement are compared with Hertz's
    closed forms, that of a quartic punch with Sneddon's, and the orders of convergence with theory.
    """
    contact, (load, indentation) = press(A, RADIUS), reference.hertz(A, RADIUS)
    r = A * np.geomspace(1.001, 100.0, 20)
    ratio = contact.displacement(r) / reference.hertz_displacement(r, A, RADIUS)
    worst = float(ratio[np.argmax(np.abs(ratio - 1.0))])
    quartic = press(A, profile=lambda r: r**4).rescaled_load / reference.power_law(A, 1.0, 4.0)[0]
    other = search_contact(A**2 / RADIUS, RADIUS, OTHER, cell=CELLS[1] * A)
    by_load, by_radius = searched()
    rows = [
        near("load over Hertz's", contact.rescaled_load / load, 1.0, LIMIT, HERTZ),
        near("indentation over Hertz's", contact.indentation / indentation, 1.0, LIMIT, HERTZ),
        near("outer displacement over Hertz's, worst", worst, 1.0, LIMIT, HERTZ),
        near("load of a quartic punch over Sneddon's", quartic, 1.0, LIMIT, SNEDDON),
        below("error estimate", contact.error_estimate, LIMIT, COARSER),
        # each degree adds at least a third of a decimal digit, as long as rounding is negligible
        above("digits gained per degree", -rate(DEGREES, spectrum()), 1.0 / 3.0, EXPONENTIAL),
        below("load by active set, relative error", float(by_load[-1]), 1e-4, HERTZ),
        below("radius by active set, relative error", float(by_radius[-1]), 1e-4, HERTZ),
        above("active set: order of the load", rate(np.log10(CELLS), by_load), 1.0, FIRST_ORDER),
        above("active set: order of the radius", rate(np.log10(CELLS), by_radius), 1.0, FIRST_ORDER),
        near(f"active set, ν = {OTHER:g}: load over Hertz", other.rescaled_load / load, 1.0, 3e-4, HERTZ),
    ]
    return Claim("Finite elements: Hertz's contact on a half-space", rows, {"Convergence": Picture(_rates)})


def rate(x: np.ndarray, error: np.ndarray) -> float:
    """Return the decimal digits by which an error grows in a unit of x."""
    return float(np.polyfit(x, np.log10(error), 1)[0])


@cache
def spectrum() -> np.ndarray:
    """Return the relative errors of the load against the degree of the elements."""
    mesh = half_space_mesh(HALF_SPACE[1][1])
    bodies = (Body(mesh, Oblate(1.0), degree, 0.5) for degree in DEGREES.tolist())
    load = [pressed(body, lambda r: 0.5 * r**2, 1.0, 1.0).rescaled_load for body in bodies]
    return np.abs(0.75 * np.array(load) - 1.0)


@cache
def searched() -> np.ndarray:
    """Return the relative errors of load and radius by active set against the cell size, (2, k).

    The coarse cells far from the contact cause an error of 3e-5 of the load. Its sign is opposite to that of
    the error at the contact, so the fitted order of the load is too high.
    """
    found = [search_contact(1.0, 1.0, cell=cell) for cell in CELLS.tolist()]
    return np.abs([(0.75 * each.rescaled_load - 1.0, each.contact_radius - 1.0) for each in found]).T


@panels(8.0, 3.2, columns=2)
def _rates(left, right):
    """Relative error of the load against Hertz's. Left: with the degree of the high-order elements the error
    falls exponentially. Right: with the cell of the active set, relative to the contact radius, load and
    radius converge at the orders in the legend, at least 1.
    """
    left.semilogy(DEGREES, spectrum(), "o-")
    left.set(xlabel="degree of the elements", ylabel="relative error of the load")
    for name, error in zip(("load", "radius"), searched(), strict=True):
        right.loglog(CELLS, error, "o-", label=f"{name}: order {rate(np.log10(CELLS), error):.1f}")
    right.set(xlabel="cell / contact radius", ylabel="relative error, active set")
