"""`metafem topography` in an empty folder."""

import warnings

import numpy as np
import pytest

import metafem as mf
from validation.scenes.height_maps import height_map

DESIGN = mf.design(
    mf.LinearLaw(6.87),
    mf.Surface.square_lattice(0.12, (3, 3), 1.5, radius=0.526, material=mf.Material(1.36)),
    limits=mf.Limits(0.12, offset=0.06),
)
MADE = DESIGN.surface.replaced(height=DESIGN.surface.height + 4e-3)


@pytest.fixture
def part(run, tmp_path):
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Could not import mpi4py", ImportWarning)
        from SurfaceTopography import Topography
    heights = 1e3 * height_map(MADE, (960, 960), 5e-3)[::-1].T  # x along the first axis, y upwards
    Topography(heights, (4.8e3, 4.8e3), unit="µm").to_x3p(str(tmp_path / "part.x3p"))
    mf.save(DESIGN, tmp_path / "design")
    return tmp_path


def test_the_made_surface_is_printed_written_and_predicted(run, part):
    measured = ("topography", "part.x3p", "--design", "design")
    text = run(*measured, "-o", "made.csv").told
    assert "height_um 4.0" in " ".join(text.split())
    assert "not read" not in run("predict", "made.csv", "--composite-modulus", "1.36 MPa").told
    data = run(*measured, "-o", "made.csv", "--force", "--json").data
    assert data["missing"] == []
    np.testing.assert_allclose(data["height_mm"], MADE.height, atol=3e-4)
