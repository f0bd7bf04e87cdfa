"""The soft cap at large strain, with slip and with stick, compared with Hertz's law and small strain."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem import reference
from metafem.caps.shapes import sphere_profile
from metafem.fe.geometry import graded_mesh
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.finite_elements.fe_cap import CELL, SEARCHED, contact, search_contact
from validation.finite_elements.frozen_meshes import FOLDER, RADIUS, SOFT_HEIGHT, cap
from validation.finite_elements.large_strain.body import FiniteContact, SoftBody
from validation.finite_elements.large_strain.press import press_sequence
from validation.sources import known_input, self_consistency

# Ten contacts on two meshes take a minute.
SLOW = True

CAP = cap(SOFT_HEIGHT)
RATIOS = np.array([0.1, 0.2, 0.3, 0.4, 0.5])

# Accuracy that the contacts are to have, relative, of the table between its nodes, and of the work over five
# contacts, whose load is a polynomial of their indentation.
REQUIRED, TABLE, WORK = 2e-3, 2.5e-3, 2e-4

# Cells at the edge of the contact and of the cap's foot of the mesh with cubic elements.
EDGES = {"contact_edge": 1e-4, "foot_edge": 0.05}

LOADS = "neo-Hookean cap over Hertz's law at the same deformed radius, finite elements at large strain"
CUBIC = "cubic displacements and quadratic pressures on another mesh"
FRESH = self_consistency(press_sequence, "finite elements at large strain at the same contact radius")
MESHES = self_consistency(press_sequence, "the same contacts on a coarser mesh")
ENERGY = known_input("identity: the work of the plane is the stored elastic energy")


def claim() -> Claim:
    """Small strain must not be used to improve Hertz's law of a soft sphere at large a/R. At a/R = 0.5 the
    load of the true cap over that of Hertz at the same contact radius is {small:.2f} by small strain, but
    only {slip:.2f} by large strain (incompressible neo-Hookean, without friction; {stick:.2f} with stick).
    The corrections have opposite signs, and Hertz's law lies between them, closer to large strain; the nearly
    constant factor from a/R = 0.1 to 0.5 is included in a fitted E*. The elements are checked by others of
    higher order on another mesh, and by the work of the plane, which must be stored as elastic energy. The
    cap is 0.38 R high and stands on a wide bonded block.
    """
    slip, stick = _contacts(False), _contacts(True)
    table = mf.TabulatedContact(*np.loadtxt(FOLDER / "soft_cap.csv", delimiter=",", skiprows=1).T)
    stored = table.for_material(mf.Material(1.0)).load(RATIOS * RADIUS, RADIUS)
    cubic, rows = self_consistency(cubic_load, CUBIC), list[Row]()
    for ratio, one, other, load in zip(RATIOS.tolist(), slip, stick, stored.tolist(), strict=True):
        where, a = f"a/R = {ratio:g}", ratio * RADIUS
        rows += [
            near(f"slip, {where}: load over Hertz", over(one), over(one, cubic_load(one)), REQUIRED, cubic),
            near(f"stored table of the soft cap, {where}: load over Hertz",
                 load / reference.hertz(a, RADIUS)[0], over(one), TABLE, FRESH),
            reported(f"stick, {where}: load over Hertz", over(other), LOADS),
        ]  # fmt: skip
    for name, contacts in (("slip", slip), ("stick", stick)):
        ratio = work(contacts) / contacts[-1].energy
        rows.append(near(f"{name}: work of the plane over the elastic energy", ratio, 1.0, WORK, ENERGY))
    worst = max(each.error_estimate for each in (*slip, *stick))
    a, small = 0.5 * RADIUS, _small(0.5)
    searched = search_contact(contact(SOFT_HEIGHT, a).indentation, RADIUS, cell=CELL * a, cap=CAP)
    exact = searched.rescaled_load / reference.hertz(a, RADIUS)[0]
    rows += [
        below("largest relative change of load and indentation with the mesh", worst, REQUIRED, MESHES),
        near("small strain, a/R = 0.5: load over Hertz", small, exact, REQUIRED, SEARCHED),
    ]
    values = {"small": small, "slip": over(slip[-1]), "stick": over(stick[-1])}
    figures = {"Load of the soft cap": Picture(_load)}
    return Claim("Finite elements: the soft cap at large strain", rows, figures, values)


@cache
def _contacts(stick: bool) -> list[FiniteContact]:
    return press_sequence(RADIUS * RATIOS, CAP, stick)


@cache
def cubic_load(found: FiniteContact) -> float:
    """Load P/E* [mm²] at a contact's deformed radius by cubic elements, flattened to its material radius.

    The deformed radius of the other elements differs by less than their error, for which the load is scaled.
    """
    edge = float(CAP.surface(np.array(found.material_radius))[0])
    mesh = graded_mesh(edge, CAP.outer, CAP.thickness, CAP.foot, **EDGES)
    state = SoftBody(mesh, CAP, 3, 0.5).flatten(lambda r: sphere_profile(r, CAP.radius))
    return float(state.rescaled_load * (found.contact_radius / state.contact_radius) ** 3)


def work(contacts: list[FiniteContact]) -> float:
    """Work of the plane up to the last contact, P/E* times length [mm³], from loads and indentations alone.

    ``P = d^(3/2)`` times a polynomial in ``sqrt(d)`` that begins with Hertz's law.
    """
    depth = np.array([0.0] + [each.indentation for each in contacts])
    share = [4.0 / 3.0 * RADIUS**0.5] + [each.rescaled_load / each.indentation**1.5 for each in contacts]
    terms = np.polynomial.polynomial.polyfit(np.sqrt(depth), share, len(contacts))
    power = 2.5 + 0.5 * np.arange(len(terms))
    return float(terms @ (depth[-1] ** power / power))


def over(found: FiniteContact, load: float | None = None) -> float:
    """Return the load of a contact, or another one, over that of Hertz at the same radius."""
    return (load or found.rescaled_load) / reference.hertz(found.contact_radius, RADIUS)[0]


def _small(ratio: float) -> float:
    """Return the same at small strain."""
    a = ratio * RADIUS
    return contact(SOFT_HEIGHT, a).rescaled_load / reference.hertz(a, RADIUS)[0]


@panels(5.6, 3.4)
def _load(ax) -> None:
    """Load over that of Hertz at the same contact radius, over a/R in the deformed state. At large strain it
    lies a few percent below 1 (circles and squares), with cubic elements (crosses) as with quadratic ones; at
    small strain (triangles) it rises above 1. The dashed line is Hertz's law.
    """
    slip, stick = _contacts(False), _contacts(True)
    ax.plot(RATIOS, [*map(over, slip)], "o-", ms=4, label="large strain, slip")
    ax.plot(RATIOS, [*map(over, stick)], "s-", ms=4, label="large strain, stick")
    cubic = [over(each, cubic_load(each)) for each in slip]
    ax.plot(RATIOS, cubic, "kx", ms=5, label="large strain, slip, cubic elements")
    ax.plot(RATIOS, [*map(_small, RATIOS.tolist())], "^-", ms=4, label="small strain, slip")
    ax.axhline(1.0, color="k", lw=0.7, ls="--")
    ax.set(xlabel="a/R, deformed", ylabel="load over that of Hertz at the same a")
