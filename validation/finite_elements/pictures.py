"""Pictures of meshes and pressures by finite elements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import reference as exact
from metafem.drawing import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from metafem.fe import PressedContact
    from metafem.fe.geometry import Cap

# Half-width of the view of the contact edge, in contact radii.
EDGE_VIEW = 0.3


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
