"""The report's section on finite elements, and its figures."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.drawing import new_figure
from metafem.drawing.inline import Drawn, drawn
from metafem.errors import InvalidInput
from metafem.inversion import Design
from metafem.models import Independent
from metafem.progress import doing, each
from metafem.reference import single_contacts as exact

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from metafem.fe import PressedContact
    from metafem.fe.axisymmetric.geometry import Cap

# Half-width of the view of the contact edge, in contact radii.
EDGE_VIEW = 0.3

HERTZ = "Pressure and displacement of a half-space against Hertz's closed forms."
MESH = "Mesh of the true cap on the bonded block: the whole mesh, and the edge of the contact."
CAP = "Pressure under the true cap on the bonded block, and Hertz's at the same contact radius."


@doing("checking the finite elements")
def elements_section(design: Design) -> dict[str, Any]:
    """Return the table of the finite-element checks, and the figures of a Hertz contact and the tallest cap.

    Their contact radius is that of the tallest asperity at the design's largest load, for independent
    asperities. The computation takes about a minute.
    """
    from metafem import fe, studies

    groups = {
        "Hertz's contact on a half-space": studies.hertz_check,
        "the true cap on a bonded block": studies.cap_check,
        "the influence of the bonded layer": studies.layer_check,
        "one cell of an infinite lattice": studies.cell_check,
    }
    rows = [
        (title, check.name, f"{check.computed:.6g}", check.expected, check.passed, check.source)
        for title in each("check", list(groups))
        for check in groups[title]()
    ]
    surface = design.surface
    last = Independent().curve(surface, design.law.rescaled_load[-1:]).last
    tallest = int(surface.height.argmax())
    a, radius = math.sqrt(float(last.area[tallest]) / math.pi), float(surface.radius[tallest])
    contact = fe.press(a, radius, surface.material.poisson_ratio)
    figures = [drawn(hertz_figure(contact, radius), "Pressure and displacement against Hertz's", HERTZ)]
    reason = ""
    try:
        figures += _cap_figures(design, a, tallest)
    except InvalidInput as error:
        reason = f"The tallest cap is not drawn: {error}."
    return {"rows": rows, "figures": figures, "contact_radius": f"{a:.3g}", "left_out": reason}


def _cap_figures(design: Design, a: float, tallest: int) -> list[Drawn]:
    from metafem import fe
    from metafem.fe.axisymmetric.geometry import Cap
    from metafem.fe.axisymmetric.mesh import graded_mesh

    surface, block = design.surface, design.surface.block
    if block is None:
        raise InvalidInput("the surface has no block")
    radius, height = float(surface.radius[tallest]), float(surface.height[tallest])
    side = math.sqrt(block.width * block.length / math.pi)
    nu = surface.material.poisson_ratio
    contact = fe.press(a, radius, nu, height=height, thickness=block.thickness, block_radius=side)
    cap = Cap(radius, height, side, block.thickness)
    mesh = graded_mesh(float(cap.surface(np.array(a))[0]), side, block.thickness, cap.foot)
    return [
        drawn(mesh_figure(mesh, cap, a), "Mesh of the tallest cap", MESH),
        drawn(cap_pressure_figure([(contact, height)], radius), "Pressure under the tallest cap", CAP),
    ]


def mesh_figure(mesh: Any, cap: Cap, contact_radius: float) -> Figure:
    """Draw the mesh of a cap with its curved edges: the whole mesh, and a view of the contact edge."""
    figure, fraction = new_figure(8.0, 3.6), np.linspace(0.0, 1.0, 9)
    i, j = mesh.facets
    r, z = cap.point(mesh.p[:, i, None] * (1.0 - fraction) + mesh.p[:, j, None] * fraction)
    top, reach, half = cap.height + 0.02, 4.0 * cap.foot, EDGE_VIEW * contact_radius
    edge = cap.height - 0.5 * contact_radius**2 / cap.radius
    views = (
        ((0.0, reach), (top - reach, top)),
        ((contact_radius - half, contact_radius + half), (edge - 1.3 * half, edge + 0.7 * half)),
    )
    for ax, (x, y) in zip(figure.subplots(1, 2), views, strict=True):
        seen = (r.min(axis=1) <= x[1]) & (r.max(axis=1) >= x[0]) & ((-z).max(axis=1) >= y[0])
        ax.plot(r[seen].T, -z[seen].T, "k-", lw=0.3)
        ax.set_aspect("equal")
        ax.set(xlabel="r [mm]", ylabel="height above the block [mm]", xlim=x, ylim=y)
    figure.axes[1].set_title("at the contact's edge", fontsize=9)
    return figure


def hertz_figure(contact: PressedContact, radius: float) -> Figure:
    """Draw the pressure and displacement of a contact on a half-space, with Hertz's closed forms."""
    a = contact.contact_radius
    inside, outside = np.linspace(0.0, a, 60), a * np.linspace(1.0, 5.0, 80)[1:]
    figure = new_figure(8.0, 3.2)
    left, right = figure.subplots(1, 2)
    left.plot(inside / a, contact.pressure(inside), ".", ms=4, label="finite elements")
    left.plot(inside / a, exact.hertz_pressure(inside, a, radius), "k-", lw=0.8, label="Hertz")
    left.set(xlabel="r/a", ylabel="pressure p/E*")
    left.legend(frameon=False)
    right.plot(outside / a, contact.displacement(outside) * 1e3, ".", ms=4)
    right.plot(outside / a, exact.hertz_displacement(outside, a, radius) * 1e3, "k-", lw=0.8)
    right.set(xlabel="r/a", ylabel="displacement outside [µm]")
    return figure


def cap_pressure_figure(contacts: list[tuple[PressedContact, float]], radius: float) -> Figure:
    """Draw the pressure under true caps of given heights [mm], and Hertz's at the same contact radius."""
    figure = new_figure(4.0 * len(contacts), 3.2)
    axes = figure.subplots(1, len(contacts), squeeze=False)[0]
    for ax, (contact, height) in zip(axes, contacts, strict=True):
        a = contact.contact_radius
        r = a * np.sin(np.linspace(0.0, 0.499 * np.pi, 80))
        ax.plot(r / a, contact.pressure(r), label="finite elements, small strain")
        ax.plot(r / a, exact.hertz_pressure(r, a, radius), "k--", lw=0.8, label="Hertz, same a")
        ax.set(xlabel="r/a", ylabel="pressure p/E*", title=f"h = {height:.3g} mm, a = {a:.3g} mm")
        ax.legend(frameon=False)
    return figure
