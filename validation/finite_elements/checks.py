"""Checks of the finite elements against the closed forms that the models use, and convergence rates."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from metafem import reference
from metafem._validate import FloatArray
from metafem.caps.shapes import sphere_profile
from metafem.fe.elements import Body
from metafem.fe.geometry import Cap, Oblate, graded_mesh, half_space_mesh
from metafem.fe.prescribed_radius import HALF_SPACE, press, pressed
from validation.check import Check
from validation.finite_elements.active_set import search_contact
from validation.sources import Source, closed_form, known_input, second_method

# Radius of the asperities, pitch of the lattice, thickness and radius of the block [mm], after Aymard et al.,
# Science 383, 200 (2024), doi:10.1126/science.adk4234.
RADIUS, PITCH, THICKNESS, BLOCK_RADIUS = 0.526, 1.5, 7.2, 10.0

# Heights and contact radii [mm] of the checked caps on the block, and the cell size of the active-set search
# over the contact radius. With this cell size, the loads of the search are accurate to 3e-4.
CAP_ROWS = ((0.12, 0.10), (0.20, 0.26))
CAP_CELLS = 1.0 / 20.3

# Largest relative error of a contact on the half-space.
LIMIT = 1e-6

HERTZ = closed_form(reference.hertz, "Hertz (1882), doi:10.1515/crll.1882.92.156")
SNEDDON = closed_form(reference.power_law, "Sneddon (1965), doi:10.1016/0020-7225(65)90019-4")
SPHERE = closed_form(reference.sneddon_sphere, "sphere, Sneddon (1965), doi:10.1016/0020-7225(65)90019-4")
INTEGRAL = "Hankel integral of the bonded layer, Johnson (1985), section 5.8, doi:10.1017/CBO9781139171731"
HANKEL = closed_form(reference.layer_influence, INTEGRAL)
CURVATURE = closed_form(
    reference.layer_lattice_sums, f"1/R + P S/2 with the curvature S of the lattice sum; {INTEGRAL}"
)
LATTICE = closed_form(reference.layer_lattice_sums, f"lattice sum of the layer's influence; {INTEGRAL}")
DINI = closed_form(reference.layer_cell, "Dini series of a cylinder on a rigid base")
SEARCHED = second_method(search_contact, "active set of quadratic elements on its own mesh")
COARSER = second_method(press, "the same with elements of a lower degree and larger at the edge")
EXPONENTIAL = known_input("theory: the error falls by a constant factor with each degree")
FIRST_ORDER = known_input("theory: order 1, as the edge of the contact is known to one cell")
EDGE_ORDER = known_input("theory: order 1 in the size of the elements at the edge")


@dataclass(frozen=True, eq=False)
class Convergence:
    """Relative errors of one quantity as the discretisation gets finer."""

    value: FloatArray
    error: FloatArray
    rate: float


def hertz_check(poisson_ratio: float = 0.5) -> list[Check]:
    """Check a contact on a half-space: `metafem.fe.press`, and a search by an active set.

    Load, indentation and displacement of a paraboloid are compared with Hertz's closed forms, and the load of
    a quartic punch is compared with Sneddon's. The check takes about 15 s.
    """
    a = 0.2
    contact = press(a, RADIUS, poisson_ratio)
    load, indentation = reference.hertz(a, RADIUS)
    r = a * np.geomspace(1.001, 100.0, 20)
    ratio = contact.displacement(r) / reference.hertz_displacement(r, a, RADIUS)
    worst = float(ratio[np.argmax(np.abs(ratio - 1.0))])
    quartic = press(a, poisson_ratio=poisson_ratio, profile=lambda r: r**4)
    power = reference.power_law(a, 1.0, 4.0)[0]
    spectrum, search = spectral_convergence(poisson_ratio), search_convergence(poisson_ratio)
    return [
        _near("load", contact.rescaled_load, load, LIMIT, HERTZ),
        _near("indentation", contact.indentation, indentation, LIMIT, HERTZ),
        _near("outer displacement over Hertz's, worst", worst, 1.0, LIMIT, HERTZ),
        _near("load of a quartic punch", quartic.rescaled_load, power, LIMIT, SNEDDON),
        _below("error estimate", contact.error_estimate, LIMIT, COARSER),
        # Each degree adds at least a third of a decimal digit, as long as rounding is negligible.
        _above("digits gained per degree", -spectrum.rate, 1.0 / 3.0, EXPONENTIAL),
        _below("load by active set, relative error", float(search[0].error[-1]), 1e-4, HERTZ),
        _below("radius by active set, relative error", float(search[1].error[-1]), 1e-4, HERTZ),
        _above("active set: order of the load", search[0].rate, 1.0, FIRST_ORDER),
        _above("active set: order of the radius", search[1].rate, 1.0, FIRST_ORDER),
    ]


def cap_check() -> list[Check]:
    """Check the true cap on the bonded block, a sphere on a half-space, and the convergence at the edge.

    The load of the cap is compared with an active-set search at the same indentation, and the load of the
    sphere is compared with Sneddon's closed form. The check takes about 10 s.
    """
    checks = []
    for height, a in CAP_ROWS:
        block: dict[str, Any] = {"height": height, "thickness": THICKNESS, "block_radius": BLOCK_RADIUS}
        contact = press(a, RADIUS, **block)
        searched = search_contact(contact.indentation, RADIUS, cell=CAP_CELLS * a, **block)
        name, load = f"h = {height} mm, a = {a} mm", reference.hertz(a, RADIUS)[0]
        over = contact.rescaled_load / load, searched.rescaled_load / load
        checks += [
            _near(f"{name}: load over Hertz", *over, 1e-3, SEARCHED),
            # the last closed node locates the edge to within one cell
            _near(f"{name}: contact radius", a, searched.last_radius, CAP_CELLS, SEARCHED),
            _below(f"{name}: error estimate", contact.error_estimate, 1e-4, COARSER),
        ]
    a = 0.5 * RADIUS
    sphere = press(a, profile=lambda r: sphere_profile(r, RADIUS))
    load, indentation = reference.sneddon_sphere(a, RADIUS)
    name = "sphere on a half-space, a/R = 0.5"
    checks += [
        _near(f"{name}: load", sphere.rescaled_load, load, LIMIT, SPHERE),
        _near(f"{name}: indentation", sphere.indentation, indentation, LIMIT, SPHERE),
    ]
    # a fit over three sizes recovers the order to 0.1
    checks.append(_above("order in the elements at the edge", cap_convergence().rate, 0.9, EDGE_ORDER))
    return checks


def layer_check(poisson_ratio: float = 0.5) -> list[Check]:
    """Check the influence of the bonded layer, over that of the half-space, against its Hankel integral."""
    a = 0.01
    contact = press(a, RADIUS, poisson_ratio, thickness=THICKNESS)
    checks = []
    for r in (0.5, 1.0, 1.5, 3.0, 5.0, 6.0, 10.0):
        displacement = float(reference.hertz_displacement(np.array(r), a, RADIUS))
        half_space = displacement / reference.hertz(a, RADIUS)[0]
        layer = half_space + float(reference.layer_regular(r, THICKNESS, poisson_ratio))
        computed = float(contact.displacement(r)) / contact.rescaled_load / half_space
        expected, passed = f"{layer / half_space:.6g} ± 0.0001", abs(computed - layer / half_space) <= 1e-4
        name = f"ν = {poisson_ratio}, r = {r} mm: layer over half-space"
        checks.append(Check(name, computed, expected, passed, HANKEL))
    return checks


def cell_check() -> list[Check]:
    """Check a cell of the infinite lattice against the layer's lattice sum and the cylinder's Dini series."""
    side = PITCH / math.sqrt(math.pi)
    total, curvature = reference.layer_lattice_sums(PITCH, THICKNESS, 0.5)
    checks = []
    for a in (0.12, 0.20, 0.28):
        contact = press(a, RADIUS, thickness=THICKNESS, cell_radius=side)
        # effective radius R_i: 1/R_i = 1/R + P S/2, P = 4 a^3/(3 R_i), S = curvature due to the neighbours
        sharpened = RADIUS * (1.0 - 2.0 / 3.0 * a**3 * curvature)
        load, single = reference.hertz(a, sharpened)
        lattice = single + load * (total + 0.1 * a**2 * curvature)
        series = single + load * reference.layer_cell(a, side, THICKNESS, 0.5)
        checks += [
            _near(f"a = {a} mm: load", contact.rescaled_load, load, 5e-4, CURVATURE),
            _near(f"a = {a} mm: indentation, lattice sum", contact.indentation, lattice, 5e-3, LATTICE),
            # The tolerance covers the series' pressure, which is Hertz's only up to terms of order a^5.
            _near(f"a = {a} mm: indentation, series", contact.indentation, series, 5e-4, DINI),
        ]
    return checks


@cache
def spectral_convergence(poisson_ratio: float = 0.5) -> Convergence:
    """Return the error of the load of a Hertz contact on a half-space against the degree of the elements."""
    degree = np.array([4, 5, 6, 7, 8])
    mesh = half_space_mesh(HALF_SPACE[1][1])

    def error(p: int) -> float:
        contact = pressed(Body(mesh, Oblate(1.0), p, poisson_ratio), lambda r: 0.5 * r**2, 1.0, 1.0)
        return abs(0.75 * contact.rescaled_load - 1.0)

    errors = np.array([error(int(p)) for p in degree])
    return Convergence(degree, errors, float(np.polyfit(degree, np.log10(errors), 1)[0]))


@cache
def search_convergence(poisson_ratio: float = 0.5) -> tuple[Convergence, Convergence]:
    """Return the errors of load and radius by active set against the cell size, in contact radii.

    The coarse cells far from the contact cause an error of 3e-5 of the load. Its sign is opposite to that of
    the error at the contact, so the fitted order of the load is too high. The fitted order of the radius is
    not affected.
    """
    # With these sizes, the contact edge always has the same position within its cell.
    cell = 1.0 / np.array([10.3, 20.3, 40.3])
    contacts = [search_contact(1.0, 1.0, poisson_ratio, cell=float(size)) for size in cell]
    load = np.abs([0.75 * contact.rescaled_load - 1.0 for contact in contacts])
    radius = np.abs([contact.contact_radius - 1.0 for contact in contacts])
    return _order(cell, load), _order(cell, radius)


def cap_convergence() -> Convergence:
    """Return the error of the indentation against the element size at the edge, for the first cap."""
    height, a = CAP_ROWS[0]
    cap = Cap(RADIUS, height, BLOCK_RADIUS, THICKNESS)
    edge = float(cap.surface(np.array(a))[0])
    size = np.array([1e-2, 1e-3, 1e-4])

    def indentation(smallest: float) -> float:
        mesh = graded_mesh(edge, BLOCK_RADIUS, THICKNESS, cap.foot, contact_edge=smallest)
        body = Body(mesh, cap, 6, 0.5)
        return pressed(body, lambda r: sphere_profile(r, RADIUS), a, cap.outer).indentation

    exact = indentation(1e-8)
    return _order(size, np.array([abs(indentation(float(s)) / exact - 1.0) for s in size]))


def _order(value: FloatArray, error: FloatArray) -> Convergence:
    return Convergence(value, error, float(np.polyfit(np.log(value), np.log(error), 1)[0]))


def _near(name: str, computed: float, expected: float, tolerance: float, source: Source) -> Check:
    """Return the check that a number equals the expected one within a relative tolerance."""
    passed = abs(computed / expected - 1.0) <= tolerance
    return Check(name, computed, f"{expected:.6g} ± {tolerance:.1g} relative", passed, source)


def _below(name: str, computed: float, limit: float, source: Source) -> Check:
    return Check(name, computed, f"at most {limit:.1g}", computed <= limit, source)


def _above(name: str, computed: float, limit: float, source: Source) -> Check:
    return Check(name, computed, f"at least {limit:.2g}", computed >= limit, source)
