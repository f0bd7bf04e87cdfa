"""Recipes of the frozen meshes and of the soft cap's table, which this module writes when it is run."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from skfem import MeshQuad

from metafem._validate import FloatArray
from metafem.fe.geometry import Cap, graded_mesh, half_space_mesh
from metafem.fe.prescribed_radius import GRADED, HALF_SPACE
from metafem.substrate import BondedLayer
from validation.finite_elements.large_strain.press import press_sequence

FOLDER = Path(__file__).parents[2] / "meshes"

# Radius of the asperities, pitch of the lattice, thickness and radius of the block [mm], after Aymard et al.,
# Science 383, 200 (2024), doi:10.1126/science.adk4234.
RADIUS, PITCH, THICKNESS, BLOCK_RADIUS = 0.526, 1.5, 7.2, 10.0

# Height of the frozen cap and contact radii of the frozen cap and cell [mm].
CAP_HEIGHT, CAP_CONTACT, CELL_CONTACT = 0.12, 0.10, 0.20

# Height of the soft cap [mm], and the contact radii of its table, a/R from 0.02 to 0.5.
SOFT_HEIGHT = 0.2
SOFT_CONTACTS = RADIUS * np.geomspace(0.02, 0.5, 12)

# Heights of the caps that are pressed deeply [mm], and the contact radii of their tables, a/R up to 0.76.
DEEP_HEIGHTS = (0.3, 0.4, 0.5)
DEEP_CONTACTS = np.geomspace(0.06, 0.4, 9)


def cap(height: float = CAP_HEIGHT) -> Cap:
    """Return the geometry of a cap of a height [mm], by default the frozen one."""
    return Cap(RADIUS, height, BLOCK_RADIUS, THICKNESS)


def recipes() -> dict[str, MeshQuad]:
    """Return each frozen mesh by its name."""
    edge, fine = float(cap().surface(np.array(CAP_CONTACT))[0]), GRADED[0][1]
    return {
        "half_space": half_space_mesh(HALF_SPACE[0][1]),
        "cap": graded_mesh(edge, BLOCK_RADIUS, THICKNESS, cap().foot, contact_edge=fine),
        "cell": graded_mesh(CELL_CONTACT, PITCH / math.sqrt(math.pi), THICKNESS, contact_edge=fine),
    }


def soft_cap(contact_radius: FloatArray = SOFT_CONTACTS, height: float = SOFT_HEIGHT) -> FloatArray:
    """Return the table of a soft cap at large strain for E* = 1 MPa: indentation, load and area, (m, 3).

    As in all contact laws, the indentation is that of a cap on a half-space. It exceeds that on the block by
    ``-P/E* self_influence`` of `BondedLayer`, which coupled models add separately. The law includes the
    compliance of the pedestal. Each contact radius takes about 6 s.
    """
    contacts = press_sequence(contact_radius, cap(height), stick=False)
    load, depth = np.array([(contact.rescaled_load, contact.indentation) for contact in contacts]).T
    sunk = -BondedLayer(THICKNESS, 0.5).self_influence * load
    return np.column_stack([depth + sunk, load, math.pi * contact_radius**2])


def deep_caps() -> dict[float, FloatArray]:
    """Return the frozen tables of caps that are pressed deeply, (9, 3) by their heights."""
    rows = np.loadtxt(FOLDER / "deep_caps.csv", delimiter=",", skiprows=1)
    return {height: rows[rows[:, 0] == height, 1:] for height in DEEP_HEIGHTS}


if __name__ == "__main__":
    for name, mesh in recipes().items():
        mesh.save(FOLDER / f"{name}.vtu")
    columns = "indentation_mm,load_N,area_mm2"
    np.savetxt(FOLDER / "soft_cap.csv", soft_cap(), "%.12e", ",", header=columns, comments="")
    deep = [(height, *row) for height in DEEP_HEIGHTS for row in soft_cap(DEEP_CONTACTS, height)]
    np.savetxt(FOLDER / "deep_caps.csv", deep, "%.12e", ",", header=f"height_mm,{columns}", comments="")
