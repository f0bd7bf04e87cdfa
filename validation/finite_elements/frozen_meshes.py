"""Recipes of the frozen meshes: `python -m validation.finite_elements.frozen_meshes` writes `meshes/`."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from skfem import MeshQuad

from metafem.fe.axisymmetric.geometry import Cap
from metafem.fe.axisymmetric.mesh import graded_mesh, half_space_mesh
from metafem.studies.element_checks import BLOCK_RADIUS, PITCH, RADIUS, THICKNESS

FOLDER = Path(__file__).parents[2] / "meshes"

# Height of the frozen cap and contact radii of the frozen cap and cell [mm].
CAP_HEIGHT, CAP_CONTACT, CELL_CONTACT = 0.12, 0.10, 0.20


def cap() -> Cap:
    """Return the geometry of the frozen cap."""
    return Cap(RADIUS, CAP_HEIGHT, BLOCK_RADIUS, THICKNESS)


def recipes() -> dict[str, MeshQuad]:
    """Return each frozen mesh by its name."""
    edge = float(cap().surface(np.array(CAP_CONTACT))[0])
    return {
        "half_space": half_space_mesh(),
        "cap": graded_mesh(edge, BLOCK_RADIUS, THICKNESS, cap().foot),
        "cell": graded_mesh(CELL_CONTACT, PITCH / math.sqrt(math.pi), THICKNESS),
    }


if __name__ == "__main__":
    for name, mesh in recipes().items():
        mesh.save(FOLDER / f"{name}.vtu")
