"""The true spherical cap on the bonded block, at small strain."""

from __future__ import annotations

from metafem import fe, studies
from metafem.report.elements import cap_pressure_figure, mesh_figure
from metafem.studies.element_checks import BLOCK_RADIUS, CAP_ROWS, RADIUS, THICKNESS
from validation.check import Claim, of_elements
from validation.finite_elements.fe_finite_strain import TEXT
from validation.finite_elements.frozen_meshes import CAP_CONTACT, FOLDER, cap

# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """Compare load and indentation with a separate program."""
    return Claim(
        "Finite elements: the spherical cap on the bonded block",
        of_elements(studies.cap_check()),
        {"mesh": _mesh, "pressure": _pressure},
        TEXT,
    )


def _mesh():
    return mesh_figure(fe.read_mesh(FOLDER / "cap.vtu"), cap(), CAP_CONTACT)


def _pressure():
    contacts = [
        (fe.press(a, RADIUS, height=height, thickness=THICKNESS, block_radius=BLOCK_RADIUS), height)
        for height, a in CAP_ROWS
    ]
    return cap_pressure_figure(contacts, RADIUS)
