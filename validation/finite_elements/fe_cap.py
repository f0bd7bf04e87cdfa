"""The true spherical cap on the bonded block, at small strain."""

from __future__ import annotations

from functools import cache

import numpy as np

from metafem import fe, reference
from metafem.caps.shapes import sphere_profile
from metafem.fe.elements import Body
from metafem.fe.geometry import graded_mesh
from metafem.fe.prescribed_radius import pressed
from validation.check import Claim, Picture, Row, above, below, near
from validation.figures import panels
from validation.finite_elements.active_set import search_contact
from validation.finite_elements.fe_hertz import COARSER, LIMIT, rate
from validation.finite_elements.frozen_meshes import BLOCK_RADIUS, RADIUS, THICKNESS, cap
from validation.sources import closed_form, known_input, second_method

# Several seconds of finite elements.
SLOW = True

# Heights and contact radii [mm], and the cell of the active-set search over the contact radius, with which
# its loads are accurate to 3e-4.
CAPS = ((0.12, 0.10), (0.20, 0.26))
CELL = 1.0 / 20.3

SPHERE = closed_form(reference.sneddon_sphere, "sphere, Sneddon (1965), doi:10.1016/0020-7225(65)90019-4")
SEARCHED = second_method(search_contact, "active set of quadratic elements on its own mesh")
EDGE_ORDER = known_input("theory: order 1 in the size of the elements at the edge")


@cache
def contact(height: float, a: float) -> fe.PressedContact:
    """Return the contact of a cap."""
    return fe.press(a, RADIUS, height=height, thickness=THICKNESS, block_radius=BLOCK_RADIUS)


def claim() -> Claim:
    """The true spherical cap on the bonded block is computed at small strain with the contact radius
    prescribed. Its load is compared with that of an active set with other elements, on another mesh, at the
    same indentation, and the same sphere on a half-space with Sneddon's closed form. At small strain the load
    of the cap is above that of Hertz's law at the same contact radius; large strain takes this back, see the
    claim on the soft cap.
    """
    rows: list[Row] = []
    for height, a in CAPS:
        found = contact(height, a)
        searched = search_contact(found.indentation, RADIUS, cell=CELL * a, cap=cap(height))
        name, load = f"h = {height} mm, a = {a} mm", reference.hertz(a, RADIUS)[0]
        over, other = found.rescaled_load / load, searched.rescaled_load / load
        rows += [
            near(f"{name}: load over Hertz", over, other, 1e-3 * other, SEARCHED),
            # the last closed node locates the edge to within one cell
            near(f"{name}: contact radius [mm]", a, searched.last_radius, CELL * a, SEARCHED),
            below(f"{name}: error estimate", found.error_estimate, 1e-4, COARSER),
        ]
    a = 0.5 * RADIUS
    sphere = fe.press(a, profile=lambda r: sphere_profile(r, RADIUS))
    load, depth = reference.sneddon_sphere(a, RADIUS)
    name = "sphere on a half-space, a/R = 0.5"
    rows += [
        near(f"{name}: load over Sneddon's", sphere.rescaled_load / load, 1.0, LIMIT, SPHERE),
        near(f"{name}: indentation over Sneddon's", sphere.indentation / depth, 1.0, LIMIT, SPHERE),
        # a fit over three sizes recovers the order to 0.1
        above("order in the elements at the edge", _edge_order(), 0.9, EDGE_ORDER),
    ]
    figures = {"Pressure below the cap": Picture(_pressure)}
    return Claim("Finite elements: the spherical cap on the bonded block", rows, figures)


def _edge_order() -> float:
    """Return the order of the indentation in the size of the elements at the edge, for the first cap."""
    body, a = cap(CAPS[0][0]), CAPS[0][1]
    edge = float(body.surface(np.array(a))[0])

    def indentation(smallest: float) -> float:
        mesh = graded_mesh(edge, BLOCK_RADIUS, THICKNESS, body.foot, contact_edge=smallest)
        return pressed(
            Body(mesh, body, 6, 0.5), lambda r: sphere_profile(r, RADIUS), a, body.outer
        ).indentation

    size, exact = np.array([1e-2, 1e-3, 1e-4]), indentation(1e-8)
    return rate(np.log10(size), np.array([abs(indentation(each) / exact - 1.0) for each in size.tolist()]))


@panels(8.0, 3.2, columns=2)
def _pressure(*axes):
    """Contact pressure over E* below two caps, over the radius relative to the contact radius, with Hertz's
    pressure at the same contact radius (dashed). The small contact on the low cap is close to Hertz's; at
    half the radius of the sphere the pressure of small strain exceeds it by 6 % in the centre.
    """
    for ax, (height, a) in zip(axes, CAPS, strict=True):
        r = a * np.sin(np.linspace(0.0, 0.499 * np.pi, 80))
        ax.plot(r / a, contact(height, a).pressure(r), label="finite elements, small strain")
        ax.plot(r / a, reference.hertz_pressure(r, a, RADIUS), "k--", lw=0.8, label="Hertz, same a")
        ax.set(xlabel="r/a", ylabel="pressure p/E*", title=f"h = {height:g} mm, a = {a:g} mm")
