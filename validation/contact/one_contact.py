"""One contact of each elastic law, against closed forms and sums of flat punches."""

from __future__ import annotations

import math

import numpy as np

import metafem as mf
from metafem import reference
from metafem.reference import sneddon_sphere
from validation.check import Claim, Picture, Row, below, near
from validation.figures import panels
from validation.published import paper
from validation.sources import closed_form, known_input

RADIUS = paper()["sample"]["radius_um"] / 1e3

# Material and adhesion energy of the paper, and contact radii [mm].
MODULUS, ENERGY = 1.36, 9e-6
RADII = np.linspace(0.02, 0.3, 8)

# Cells per radius of a resolved contact.
CELLS = 32

# Two evaluations of a closed form; numerical integrals and derivatives.
ROUNDING, NUMERICAL = 1e-12, 1e-8

CLOSED = {
    "paraboloid": (mf.Hertz(), lambda a: reference.hertz(a, RADIUS), reference.hertz),
    "sphere": (mf.Elastic(mf.Sphere()), lambda a: sneddon_sphere(a, RADIUS), sneddon_sphere),
    "power 1.5": (mf.Elastic(mf.Power(1.5)), lambda a: _power(a, 1.5), reference.power_law),
    "power 4": (mf.Elastic(mf.Power(4.0)), lambda a: _power(a, 4.0), reference.power_law),
}  # fmt: skip

PUNCHES = known_input("identity: the pressure is that of flat punches s with loads 2 s dD(s)")
MODULI = known_input("identity: E = 3 G and E* = 2 G/(1 − ν) = E/(1 − ν²) of an incompressible solid")
ENDS = closed_form(reference.jkr_contact_radius, "pull-off load −3/2 π w R, where the root is 0")
JKR = closed_form(reference.jkr_contact_radius, "radius of an adhesive contact over its load")


def claim() -> Claim:
    """Indentation, load and second moment of the pressure are compared with closed forms of Hertz and
    Sneddon, and with sums of flat punches, of which every axisymmetric contact consists. Adhesive paraboloids
    are compared with the closed form of Johnson, Kendall and Roberts, from pull-off to large loads. All other
    claims rest on these laws.
    """
    rows: list[Row] = []
    for name, (law, exact, source) in CLOSED.items():
        load, depth = np.array([exact(float(a)) for a in RADII]).T
        form = closed_form(source, f"{name}: load and indentation")
        found = law.load(RADII, RADIUS), law.indentation(RADII, RADIUS), law.contact_radius(depth, RADIUS)
        worst = max(_error(*pair) for pair in zip(found, (load, depth, RADII), strict=True))
        moment = _error(law.second_moment(RADII, RADIUS), [_moment(exact, float(a)) for a in RADII])
        rows += [
            below(f"{name}: load, indentation and contact radius, largest relative error",
                  worst, ROUNDING, form),
            below(f"{name}: second moment of the pressure, largest relative error",
                  moment, NUMERICAL, PUNCHES),
        ]  # fmt: skip
    rows += [*_adhesive(), *_states()]
    return Claim("One contact of each elastic law", rows, {"Loads": Picture(_figure)})


def _adhesive() -> list[Row]:
    law = mf.JKR(ENERGY).for_material(mf.Material(MODULUS))
    pull = 1.5 * math.pi * ENERGY / MODULUS * RADIUS
    load = pull * np.concatenate([-1.0 + np.geomspace(1e-6, 1.0, 20), np.geomspace(0.01, 1e4, 20)])
    a = np.array([reference.jkr_contact_radius(float(p), RADIUS, ENERGY / MODULUS) for p in load])
    plain, depth = np.array([reference.hertz(float(x), RADIUS) for x in a]).T
    lost = (plain - load) / (2.0 * a)
    surface = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, mf.Material(MODULUS))
    model = mf.Independent(contact=mf.JKR(ENERGY))
    lowest = float(law.load(law.pull_off_radius(RADIUS), RADIUS))
    solved = mf.friction_law(surface, model, load=MODULUS * load[load > 0.0]).area
    return [
        below("adhesive paraboloid: load, largest error over the pull-off load",
              float(np.abs(law.load(a, RADIUS) - load).max() / pull), NUMERICAL, JKR),
        below("adhesive paraboloid: indentation, largest error over its decrease by adhesion at pull-off",
              float(np.abs(law.indentation(a, RADIUS) - (depth - lost)).max() / lost.min()), 1e-9, PUNCHES),
        near("adhesive paraboloid: pull-off load over w R",
             MODULUS * lowest / (ENERGY * RADIUS), -1.5 * math.pi, 1e-9, ENDS),
        below("adhesive paraboloid: area of the solved contact, largest relative error",
              _error(solved, np.pi * a[load > 0.0] ** 2), 1e-9, JKR),
    ]  # fmt: skip


def _states() -> list[Row]:
    """Compare a contact under a load in newtons, alone and resolved into cells, with the closed form."""
    a, shear = 0.2, 0.34  # contact radius [mm], and shear modulus [MPa] of the paper's elastomer
    material = mf.Material.from_young(3.0 * shear, 0.5)  # E = 3 G
    exact = 2.0 * shear / (1.0 - 0.5)  # E* = 2 G/(1 - nu)
    load, depth = reference.hertz(a, RADIUS)
    surface = mf.Surface(np.zeros((1, 2)), [0.2], RADIUS, material)
    state = mf.equilibrium(surface, load=exact * load)
    resolved = mf.equilibrium(surface, mf.BoundaryElements(a / CELLS), approach=depth)
    form = closed_form(reference.hertz, "load, area and stiffness 2 E* a")
    cells = closed_form(reference.hertz, "Hertz, within 0.4 over the square of the cells per radius")
    bound = 0.4 / CELLS**2
    rows = [near("E* of a rubber with G = 0.34 MPa [MPa]", material.composite_modulus, exact, 1e-12, MODULI)]
    for name, found, expected, tolerance, source in (
        ("state under a load: load over that given", state.load, exact * load, 1e-12, form),
        ("state under a load: area over π a²", state.area, np.pi * a**2, 1e-12, form),
        ("state under a load: stiffness over 2 E* a", state.stiffness, 2.0 * exact * a, 1e-12, form),
        ("resolved contact: load", resolved.load, exact * load, bound, cells),
        ("resolved contact: area by the second moments", resolved.area, np.pi * a**2, bound, cells),
    ):
        rows.append(near(name, found / expected, 1.0, tolerance, source))
    return rows


def _power(a: float, exponent: float) -> tuple[float, float]:
    return reference.power_law(a, 0.5 * RADIUS ** (1.0 - exponent), exponent)


def _moment(exact, a: float) -> float:
    """Second moment of the pressure [mm⁴] of flat punches: int 4/3 s³ dD = 4/3 a³ D − int 4 s² D ds."""
    node, weight = np.polynomial.legendre.leggauss(40)
    t = 0.5 * (node + 1.0)  # s = a t², smooth where D has a root
    depth = np.array([exact(float(a * x**2))[1] for x in t])
    rest = 0.5 * weight @ (4.0 * (a * t**2) ** 2 * depth * 2.0 * a * t)
    return float(4.0 / 3.0 * a**3 * exact(a)[1] - rest)


def _error(found, expected) -> float:
    """Return the largest relative difference."""
    return float(np.abs(np.asarray(found) / expected - 1.0).max())


@panels(6.0, 3.4)
def _figure(ax):
    """Load P/E* [mm²] over the contact radius a [mm] of four caps of the paper's summit radius, by metafem
    (lines) and by closed forms (dots). The paraboloid and the sphere agree for narrow contacts.
    """
    a = np.linspace(0.0, 0.3, 100)
    for name, (law, exact, _) in CLOSED.items():
        (line,) = ax.plot(a, law.load(a, RADIUS), label=name)
        ax.plot(RADII, [exact(float(x))[0] for x in RADII], "o", ms=4, color=line.get_color())
    ax.set(xlabel="contact radius  a [mm]", ylabel="load  P/E* [mm²]")
