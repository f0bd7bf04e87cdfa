"""Writers of meshes: binary STL, 3MF and OBJ."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from metafem.files.part.block import Mesh

# Layout of a triangle in a binary STL file: little-endian, without padding.
_STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_STL_HEADER = 80

_3MF_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">\
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>\
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"""
_3MF_RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">\
<Relationship Target="/3D/3dmodel.model" Id="model" \
Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"""
_3MF_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" \
xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<metadata name="Title">{title}</metadata>
<resources><object id="1" type="model" name="{title}"><mesh>
<vertices>
"""
_3MF_FOOT = '</triangles>\n</mesh></object></resources>\n<build><item objectid="1"/></build>\n</model>\n'

# Constant date of all members of an archive, so that equal meshes give equal files.
_NO_DATE = (1980, 1, 1, 0, 0, 0)


def write_stl(mesh: Mesh, path: Path, title: str) -> None:
    """Write binary STL. Its header states the unit, for which the format has no field, and the title."""
    with path.open("wb") as file:
        # a file must not begin with "solid", because programs then read it as text
        file.write(f"metafem {title}; units: mm".encode("ascii").ljust(_STL_HEADER)[:_STL_HEADER])
        file.write(np.uint32(len(mesh.faces)).astype("<u4").tobytes())
        for corners in mesh.corners():
            normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            rows = np.zeros(len(corners), dtype=_STL_TRIANGLE)
            rows["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
            rows["corners"] = corners
            file.write(rows.tobytes())


def write_obj(mesh: Mesh, path: Path, title: str) -> None:
    """Write Wavefront OBJ; a comment states the unit, for which the format has no field."""
    with path.open("wb") as file:
        file.write(f"# metafem {title}\n# units: mm\no {title.split()[0]}\n".encode("ascii"))
        np.savetxt(file, mesh.vertices, "v %.9g %.9g %.9g")
        np.savetxt(file, mesh.faces + 1, "f %d %d %d")


def write_3mf(mesh: Mesh, path: Path, title: str) -> None:
    """Write 3MF, a ZIP archive of XML files; its unit is the millimetre."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (("[Content_Types].xml", _3MF_TYPES), ("_rels/.rels", _3MF_RELATIONS)):
            archive.writestr(_member(name), text)
        with archive.open(_member("3D/3dmodel.model"), "w", force_zip64=True) as file:
            file.write(_3MF_HEAD.format(title=title).encode("ascii"))
            np.savetxt(file, mesh.vertices, '<vertex x="%.9g" y="%.9g" z="%.9g"/>')
            file.write(b"</vertices>\n<triangles>\n")
            np.savetxt(file, mesh.faces, '<triangle v1="%d" v2="%d" v3="%d"/>')
            file.write(_3MF_FOOT.encode("ascii"))


def _member(name: str) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, _NO_DATE)
    info.compress_type = zipfile.ZIP_DEFLATED
    return info


# The writer of each format, by the extension of the file's name.
WRITERS: Mapping[str, Callable[[Mesh, Path, str], None]] = {
    "stl": write_stl,
    "3mf": write_3mf,
    "obj": write_obj,
}


def stl_size(triangles: int) -> int:
    """Return the size of a binary STL file [bytes]."""
    return _STL_HEADER + 4 + _STL_TRIANGLE.itemsize * triangles
