"""The closed forms that the models rest on, each against finite elements, with observed rates."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from skfem import MeshQuad

from metafem._validate import FloatArray
from metafem.fe.axisymmetric.active_set import search_contact
from metafem.fe.axisymmetric.geometry import Cap, Oblate
from metafem.fe.axisymmetric.mesh import graded_mesh, half_space_mesh
from metafem.fe.axisymmetric.prescribed_radius import Pressed, graded, spectral
from metafem.fe.axisymmetric.press import press
from metafem.reference import bonded_layer, single_contacts

# The asperities, the lattice and the block of Aymard et al., Science 383, 200 (2024).
RADIUS, PITCH, THICKNESS, BLOCK_RADIUS = 0.526, 1.5, 7.2, 10.0

# Load and indentation over Hertz's at the same contact radius, by height and contact radius [mm]: true cap
# on the bonded block, nu = 0.5, small strain; numbers of a separate program, good to 0.2 %.
CAP_ROWS = {(0.12, 0.10): (1.016, 1.015), (0.20, 0.26): (1.112, 1.121)}

HERTZ = "Hertz (1882), doi:10.1515/crll.1882.92.156"
SNEDDON = "Sneddon (1965), doi:10.1016/0020-7225(65)90019-4"
HANKEL = "Hankel integral of the bonded layer, Johnson (1985), section 5.8, doi:10.1017/CBO9781139171731"
CURVATURE = f"1/R + P S/2 with the curvature S of the lattice sum; {HANKEL}"
LATTICE = f"lattice sum of the layer's influence; {HANKEL}"
DINI = "Dini series of a cylinder on a rigid base, metafem.reference.bonded_layer.cell_influence"
FIRST_ORDER = "at least order 1: the edge of the contact is known to one cell; fitted"
OTHER = "small-strain finite elements of a separate program that shares no code with metafem, unpublished"


@dataclass(frozen=True)
class Check:
    """A computed number beside what it should be.

    Attributes
    ----------
    name : str
    computed, expected : float
    error : float
        What is compared with the tolerance; for a rate, by how much it falls short.
    tolerance : float
    source : str
        Where the expected number comes from.
    expectation : str
        The expected number and the tolerance in words.
    """

    name: str
    computed: float
    expected: float
    error: float
    tolerance: float
    source: str
    expectation: str

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance."""
        return self.error <= self.tolerance


@dataclass(frozen=True, eq=False)
class Convergence:
    """Relative errors of one quantity as the discretisation gets finer.

    Attributes
    ----------
    parameter : str
        What is varied.
    value, error : ndarray
        The parameter and the relative errors.
    rate : float
        Slope of log(error): by log(cell), or by the degree in decimal digits.
    """

    parameter: str
    value: FloatArray
    error: FloatArray
    rate: float


def hertz_check(poisson_ratio: float = 0.5) -> list[Check]:
    """Hertz's load, indentation and outer field, a quartic punch, and the search by active set."""
    a = 0.2
    contact = press(a, RADIUS, poisson_ratio)
    load, indentation = single_contacts.hertz(a, RADIUS)
    r = a * np.geomspace(1.001, 100.0, 20)
    field = contact.displacement(r) / single_contacts.hertz_displacement(r, a, RADIUS)
    worst = float(field[np.argmax(np.abs(field - 1.0))])
    quartic = press(a, poisson_ratio=poisson_ratio, profile=lambda r: r**4)
    power = single_contacts.power_law(a, 1.0, 4.0)[0]
    spectrum, search = spectral_convergence(poisson_ratio), search_convergence(poisson_ratio)
    return [
        _relative("load", contact.rescaled_load, load, 1e-8, HERTZ),
        _relative("indentation", contact.indentation, indentation, 1e-8, HERTZ),
        _relative("outer field over Hertz's, worst", worst, 1.0, 1e-8, HERTZ),
        _relative("load of a quartic punch", quartic.rescaled_load, power, 1e-8, SNEDDON),
        _bound("error estimate", contact.error_estimate, 1e-6, "difference between two degrees, this check"),
        # Every degree gains a third of a digit or more while rounding is far away.
        _rate("digits gained per degree", -spectrum.rate, 1.0 / 3.0, "exponential convergence; fitted"),
        _bound("load by active set, relative error", float(search[0].error[-1]), 1e-4, HERTZ),
        _bound("radius by active set, relative error", float(search[1].error[-1]), 1e-4, HERTZ),
        _rate("active set: order of the load", search[0].rate, 1.0, FIRST_ORDER),
        _rate("active set: order of the radius", search[1].rate, 1.0, FIRST_ORDER),
    ]


def cap_check() -> list[Check]:
    """The true cap on the bonded block, and the rate at which the edge's bracket closes."""
    checks = []
    for (height, a), expected in CAP_ROWS.items():
        contact = press(a, RADIUS, height=height, thickness=THICKNESS, block_radius=BLOCK_RADIUS)
        hertz = single_contacts.hertz(a, RADIUS)
        name = f"h = {height} mm, a = {a} mm"
        checks += [
            _relative(f"{name}: load over Hertz", contact.rescaled_load / hertz[0], expected[0], 2e-3, OTHER),
            _relative(
                f"{name}: indentation over Hertz", contact.indentation / hertz[1], expected[1], 2e-3, OTHER
            ),
            _bound(
                f"{name}: error estimate",
                contact.error_estimate,
                1e-4,
                "bracket between two edge criteria, this check",
            ),
        ]
    # The bracket spans one element at the edge: order one, which a fit over three sizes gives to 0.1.
    checks.append(
        _rate(
            "order of the edge's bracket",
            cap_convergence().rate,
            0.9,
            "theory: order 1, one element at the edge; fitted",
        )
    )
    return checks


def layer_check(poisson_ratio: float = 0.5) -> list[Check]:
    """The layer's influence against its Hankel integral, in units of the half-space's."""
    a = 0.01
    contact = press(a, RADIUS, poisson_ratio, thickness=THICKNESS)
    checks = []
    for r in (0.5, 1.0, 1.5, 3.0, 5.0, 6.0, 10.0):
        field = float(single_contacts.hertz_displacement(np.array(r), a, RADIUS))
        half_space = field / single_contacts.hertz(a, RADIUS)[0]
        layer = half_space + float(bonded_layer.regular_influence(r, THICKNESS, poisson_ratio))
        computed = float(contact.displacement(r)) / contact.rescaled_load
        checks.append(
            _absolute(
                f"layer over half-space at {r} mm", computed / half_space, layer / half_space, 1e-4, HANKEL
            )
        )
    return checks


def cell_check() -> list[Check]:
    """One cell of the infinite lattice against the layer's lattice sum and the cylinder's own series."""
    side = PITCH / math.sqrt(math.pi)
    total, curvature = bonded_layer.lattice_sums(PITCH, THICKNESS, 0.5)
    checks = []
    for a in (0.12, 0.20, 0.28):
        contact = press(a, RADIUS, thickness=THICKNESS, cell_radius=side)
        # 1/R_i = 1/R + P S/2 with P = 4 a^3/(3 R_i).
        bent = 1.0 / RADIUS / (1.0 - 2.0 / 3.0 * a**3 * curvature)
        load, own = 4.0 / 3.0 * a**3 * bent, a**2 * bent
        lattice = own + load * (total + 0.1 * a**2 * curvature)
        series = own + load * bonded_layer.cell_influence(a, side, THICKNESS, 0.5)
        checks += [
            _relative(f"a = {a} mm: load", contact.rescaled_load, load, 5e-4, CURVATURE),
            _relative(f"a = {a} mm: indentation", contact.indentation, lattice, 5e-3, LATTICE),
            # The series' own error: the pressure is Hertz's in it, up to terms of a^5.
            _relative(f"a = {a} mm: indentation", contact.indentation, series, 5e-4, DINI),
        ]
    return checks


def spectral_convergence(poisson_ratio: float = 0.5) -> Convergence:
    """Error of Hertz's load in the half-space by the degree of the elements."""
    degree = np.array([4, 5, 6, 7, 8])
    mesh = half_space_mesh()

    def error(p: int) -> float:
        pressed = spectral(mesh, Oblate(1.0), p, poisson_ratio, lambda r: 0.5 * r**2, 1.0)
        return abs(0.75 * pressed.load - 1.0)

    errors = np.array([error(int(p)) for p in degree])
    return Convergence("degree", degree, errors, float(np.polyfit(degree, np.log10(errors), 1)[0]))


def search_convergence(poisson_ratio: float = 0.5) -> tuple[Convergence, Convergence]:
    """Errors of the active set's load and radius by the cell, in contact radii.

    The growing cells far away leave 3e-5 of the load, of the other sign than the contact's own error: the
    load's fitted order is flattered by it, the radius's is not.
    """
    # The edge of the contact stands at the same place within its cell in all of them.
    cell = 1.0 / np.array([10.3, 20.3, 40.3])
    found = [search_contact(1.0, 1.0, poisson_ratio, cell=float(size)) for size in cell]
    load = np.abs([0.75 * contact.rescaled_load - 1.0 for contact in found])
    radius = np.abs([contact.contact_radius - 1.0 for contact in found])
    return _order("cell", cell, load), _order("cell", cell, radius)


def cap_convergence() -> Convergence:
    """Half-width of the edge's bracket by the size of the last elements, for the first cap."""
    height, a = next(iter(CAP_ROWS))
    cap = Cap(RADIUS, height, BLOCK_RADIUS, THICKNESS)
    edge = float(cap.surface(np.array(a))[0])
    size = np.array([1e-2, 1e-3, 1e-4])

    def bracket(smallest: float) -> float:
        mesh = graded_mesh(edge, BLOCK_RADIUS, THICKNESS, cap.foot, contact_edge=smallest)
        return _cap_pressed(mesh, cap, a).bracket

    return _order("last element", size, np.array([bracket(float(s)) for s in size]))


def _cap_pressed(mesh: MeshQuad, cap: Cap, a: float) -> Pressed:
    """Press a sphere's profile on the cap with the lowest degree."""

    def profile(r: FloatArray) -> FloatArray:
        return np.asarray(r**2 / (cap.radius + np.sqrt(cap.radius**2 - r**2)))

    return graded(mesh, cap, 4, 0.5, profile, a, cap.outer, False)


def _order(parameter: str, value: FloatArray, error: FloatArray) -> Convergence:
    return Convergence(parameter, value, error, float(np.polyfit(np.log(value), np.log(error), 1)[0]))


def _relative(name: str, computed: float, expected: float, tolerance: float, source: str) -> Check:
    words = f"{expected:.6g} to {tolerance:.1g} of it"
    return Check(name, computed, expected, abs(computed / expected - 1.0), tolerance, source, words)


def _absolute(name: str, computed: float, expected: float, tolerance: float, source: str) -> Check:
    words = f"{expected:.6g} ± {tolerance:.1g}"
    return Check(name, computed, expected, abs(computed - expected), tolerance, source, words)


def _bound(name: str, computed: float, limit: float, source: str) -> Check:
    return Check(name, computed, 0.0, computed, limit, source, f"at most {limit:.1g}")


def _rate(name: str, computed: float, at_least: float, source: str) -> Check:
    shortfall = max(0.0, at_least - computed)
    return Check(name, computed, at_least, shortfall, 0.0, source, f"at least {at_least:.2g}")
