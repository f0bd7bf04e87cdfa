"""`metafem topography` in an empty folder."""

import json
from dataclasses import replace

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
PIXEL = ("--pixel", "5 um", "--height-unit", "um")


@pytest.fixture(scope="module")
def heights():
    return 1e3 * height_map(MADE, (960, 960), 5e-3)


@pytest.fixture
def part(run, tmp_path, heights):
    np.save(tmp_path / "part.npy", heights)
    mf.save(DESIGN, tmp_path / "design")
    return tmp_path


def test_the_made_surface_is_printed_written_and_predicted(run, part):
    result = run(
        *("topography", "part.npy", *PIXEL, "--design", "design", "-o", "made.csv"),
        *("--corrected", "next.csv", "--picture", "made.svg"),
    )
    assert result.exit_code == 0, result.output
    for text in (
        "9 of 9 asperities measured",
        "mean height error +4",
        "expected with corrected heights",
        "law of the made surface: A0 differs",
        "wrote made.csv",
    ):
        assert text in result.output
    assert "<svg" in (part / "made.svg").read_text("utf-8")
    following = np.loadtxt(part / "next.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(following[:, 3], DESIGN.surface.height - 4e-3, atol=2e-4)
    predicted = run("predict", "made.csv", "--composite-modulus", "1.36 MPa", "--json")
    assert predicted.exit_code == 0
    assert "not read" not in predicted.output
    again = run("topography", "part.npy", *PIXEL, "--design", "design", "-o", "made.csv", "--force")
    assert again.exit_code == 0


def test_json_holds_the_heights_and_the_correction(run, part):
    result = run("topography", "part.npy", *PIXEL, "--design", "design", "--common-radius", "--json")
    data = json.loads(result.stdout)
    assert data["missing"] == []
    np.testing.assert_allclose(data["height_mm"], MADE.height, atol=3e-4)
    assert len(set(data["radius_mm"])) == 1
    assert data["correction"]["terms"]["offset"]["value"] == pytest.approx(4e-3, abs=2e-4)
    assert data["correction"]["expected_error_mm"] < data["correction"]["error_mm"]


@pytest.mark.slow
def test_a_missing_summit_is_named(run, part, heights):
    gone = heights.copy()
    gone[:320, :320] = np.nan  # on the upper left: site 6
    np.save(part / "part.npy", gone)
    result = run("topography", "part.npy", *PIXEL, "--design", "design")
    assert "8 of 9 asperities measured" in result.output
    assert "asperity 6 of the design, at (-1.500, 1.500) mm, is missing" in result.output.replace("\n", " ")


@pytest.mark.slow
def test_a_scale_is_about_the_mean_height(run, part):
    design = DESIGN.surface.replaced(height=np.linspace(0.08, 0.16, 9))
    mf.save(replace(DESIGN, surface=design), "steps")
    np.save(part / "part.npy", height_map(design.replaced(height=1.02 * design.height), (960, 960), 5e-3))
    result = run("topography", "part.npy", "--pixel", "5 um", "--height-unit", "mm", "--design", "steps")
    assert "mean height error +2.4" in result.output
    assert "% of the height above or below the mean of 120 um" in " ".join(result.output.split())
