"""The summits and their contacts as a VTU file, for viewers such as ParaView."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from metafem.inversion import Design
from metafem.prediction import equilibrium


def write_surface(design: Design, path: str | Path) -> None:
    """Write the summits as points with their contacts at the law's largest load, in VTU format.

    Point data: site in the template, height and radius [mm], and load [N], area [mm^2] and
    contact_radius [mm] under the law's model.
    """
    import meshio

    surface, law = design.surface, design.law
    state = equilibrium(surface, law.model, load=float(law.load[-1]))
    mesh = meshio.Mesh(
        np.column_stack([surface.position, surface.height]),
        [("vertex", np.arange(surface.count)[:, None])],
        point_data={
            "site": design.sites,
            "height": surface.height,
            "radius": surface.radius,
            "load": state.asperity_load,
            "area": state.asperity_area,
            "contact_radius": np.sqrt(state.asperity_area / np.pi),
        },
    )
    mesh.write(path, file_format="vtu")
