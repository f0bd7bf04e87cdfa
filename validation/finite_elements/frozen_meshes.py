"""Recipes of the frozen meshes and of the soft cap's table, which this module writes when it is run."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from skfem import MeshQuad

from metafem._validate import FloatArray
from metafem.fe.geometry import Cap, graded_mesh, half_space_mesh
from metafem.fe.prescribed_radius import GRADED, HALF_SPACE
from metafem.material import Material
from validation.finite_elements.checks import BLOCK_RADIUS, PITCH, RADIUS, THICKNESS
from validation.finite_elements.large_strain.press import tabulated_contact

FOLDER = Path(__file__).parents[2] / "meshes"

# Height of the frozen cap and contact radii of the frozen cap and cell [mm].
CAP_HEIGHT, CAP_CONTACT, CELL_CONTACT = 0.12, 0.10, 0.20

# Height of the soft cap [mm], and the contact radii of its table, a/R from 0.02 to 0.5.
SOFT_HEIGHT = 0.2
SOFT_CONTACTS = RADIUS * np.geomspace(0.02, 0.5, 12)

# Heights of the caps that are pressed deeply [mm], and the contact radii of their tables, a/R up to 0.76.
DEEP_HEIGHTS = (0.3, 0.4, 0.5)
DEEP_CONTACTS = np.geomspace(0.06, 0.4, 9)


def cap() -> Cap:
    """Return the geometry of the frozen cap."""
    return Cap(RADIUS, CAP_HEIGHT, BLOCK_RADIUS, THICKNESS)


def recipes() -> dict[str, MeshQuad]:
    """Return each frozen mesh by its name."""
    edge, fine = float(cap().surface(np.array(CAP_CONTACT))[0]), GRADED[0][1]
    return {
        "half_space": half_space_mesh(HALF_SPACE[0][1]),
        "cap": graded_mesh(edge, BLOCK_RADIUS, THICKNESS, cap().foot, contact_edge=fine),
        "cell": graded_mesh(CELL_CONTACT, PITCH / math.sqrt(math.pi), THICKNESS, contact_edge=fine),
    }


def soft_cap(contact_radius: FloatArray = SOFT_CONTACTS, height: float = SOFT_HEIGHT) -> FloatArray:
    """Return the table of a soft cap at large strain for E* = 1 MPa: indentation, load and area, (m, 3)."""
    law = tabulated_contact(
        contact_radius,
        RADIUS,
        height=height,
        thickness=THICKNESS,
        block_radius=BLOCK_RADIUS,
        material=Material(1.0),
    )
    return law.table.T


def deep_caps() -> dict[float, FloatArray]:
    """Return the frozen tables of caps that are pressed deeply, (9, 3) by their heights."""
    rows = np.loadtxt(FOLDER / "deep_caps.csv", delimiter=",", skiprows=1)
    return {height: rows[rows[:, 0] == height, 1:] for height in DEEP_HEIGHTS}


if __name__ == "__main__":
    for name, mesh in recipes().items():
        mesh.save(FOLDER / f"{name}.vtu")
    np.savetxt(
        FOLDER / "soft_cap.csv",
        soft_cap(),
        "%.12e",
        ",",
        header="indentation_mm,load_N,area_mm2",
        comments="",
    )
    deep = [
        np.column_stack([np.full(DEEP_CONTACTS.size, height), soft_cap(DEEP_CONTACTS, height)])
        for height in DEEP_HEIGHTS
    ]
    np.savetxt(
        FOLDER / "deep_caps.csv",
        np.concatenate(deep),
        "%.12e",
        ",",
        header="height_mm,indentation_mm,load_N,area_mm2",
        comments="",
    )
