"""The true spherical cap on the bonded block."""

from __future__ import annotations

import numpy as np

from metafem import fe
from metafem.fe.checks import BLOCK_RADIUS, RADIUS, THICKNESS
from metafem.reference import single_contacts as exact
from metafem.report.svg import new_figure
from validation.check import Claim, from_elements
from validation.fe_finite_strain import TEXT
from validation.frozen_meshes import CAP_CONTACT, CAP_HEIGHT, FOLDER, cap


def claim() -> Claim:
    """Compare load and indentation with another computation."""
    return Claim(
        "Finite elements: the spherical cap on the bonded block",
        from_elements(fe.cap_check()),
        {"mesh": _mesh, "pressure": _pressure},
        TEXT,
    )


def _mesh():
    """Draw the frozen mesh near the contact, with its curved sides."""
    mesh, geometry = fe.read_mesh(FOLDER / "cap.vtu"), cap()
    figure = new_figure(8.0, 3.6)
    share = np.linspace(0.0, 1.0, 9)
    for ax, limit in zip(figure.subplots(1, 2), (4.0 * geometry.foot, 0.03), strict=True):
        lines = [mesh.p[:, i, None] * (1.0 - share) + mesh.p[:, j, None] * share for i, j in mesh.facets.T]
        for line in lines:
            r, z = geometry.point(line)
            ax.plot(r, -z, "k-", lw=0.3)
        ax.set_aspect("equal")
        ax.set(xlabel="r [mm]", ylabel="height above the block [mm]")
        centre = 0.0 if limit > 1.0 else CAP_CONTACT
        ax.set_xlim(max(0.0, centre - limit), centre + limit)
        top = CAP_HEIGHT if limit > 1.0 else CAP_HEIGHT - 0.5 * CAP_CONTACT**2 / RADIUS
        ax.set_ylim(top - (limit if limit > 1.0 else 0.04), top + 0.02)
    figure.axes[1].set_title("at the contact's edge", fontsize=9)
    return figure


def _pressure():
    figure = new_figure(8.0, 3.2)
    for ax, (height, a) in zip(figure.subplots(1, 2), ((0.12, 0.10), (0.20, 0.26)), strict=True):
        contact = fe.press(a, RADIUS, height=height, thickness=THICKNESS, block_radius=BLOCK_RADIUS)
        r = a * np.sin(np.linspace(0.0, 0.499 * np.pi, 80))
        ax.plot(r / a, contact.pressure(r), label="finite elements, small strain")
        ax.plot(r / a, exact.hertz_pressure(r, a, RADIUS), "k--", lw=0.8, label="Hertz, same a")
        ax.set(xlabel="r/a", ylabel="pressure p/E*", title=f"h = {height} mm, a = {a} mm")
        ax.legend(frameon=False)
    return figure
