import meshio
import numpy as np

import metafem as mf
from metafem.files.result.vtu import write_surface


def test_the_field_file_holds_the_contacts_at_the_largest_load(tmp_path):
    template = mf.Surface.square_lattice(0.12, (3, 3), radius=0.526, material=mf.Material(1.36))
    design = mf.design(mf.LinearLaw(6.87), template)
    write_surface(design, tmp_path / "surface.vtu")
    mesh = meshio.read(tmp_path / "surface.vtu")
    np.testing.assert_array_equal(
        mesh.points, np.column_stack([design.surface.position, design.surface.height])
    )
    np.testing.assert_array_equal(mesh.point_data["site"], design.sites)
    # exact sums of the same numbers: rounding alone
    np.testing.assert_allclose(mesh.point_data["load"].sum(), design.law.load[-1], rtol=1e-12)
    np.testing.assert_allclose(mesh.point_data["area"].sum(), design.law.area[-1], rtol=1e-12)
    np.testing.assert_allclose(
        np.pi * mesh.point_data["contact_radius"] ** 2, mesh.point_data["area"], rtol=1e-12
    )
