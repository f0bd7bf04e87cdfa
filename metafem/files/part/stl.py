"""Meshes as binary STL."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from metafem.files.part.block import Mesh

# Layout of a triangle in a binary STL file: little-endian, without padding.
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER = 80


def write_stl(mesh: Mesh, path: Path, title: str) -> None:
    """Write binary STL. Its header states the unit, for which the format has no field, and the title."""
    with path.open("wb") as file:
        # a file must not begin with "solid", because programs then read it as text
        file.write(f"metafem {title}; units: mm".encode("ascii").ljust(_HEADER)[:_HEADER])
        file.write(np.uint32(len(mesh.faces)).astype("<u4").tobytes())
        for corners in mesh.corners():
            normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            rows = np.zeros(len(corners), dtype=_TRIANGLE)
            rows["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
            rows["corners"] = corners
            file.write(rows.tobytes())


def stl_size(triangles: int) -> int:
    """Return the size of a binary STL file [bytes]."""
    return _HEADER + 4 + _TRIANGLE.itemsize * triangles
