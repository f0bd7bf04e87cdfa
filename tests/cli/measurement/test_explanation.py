"""`metafem compare --explain`."""

import json
import math
from pathlib import Path

import pytest

import metafem as mf


@pytest.fixture
def tilted(demo):
    """Write the table of the contacts of the demo "linear", tilted by 0.1 degrees."""
    demo("linear")
    surface = mf.load("linear").surface
    made = surface.tilted(math.radians(0.1), 0.0)
    lines = [
        "image,test,load_N,friction_force_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2,"
        "sheared_area_mm2,sheared_area_error_mm2,remark"
    ]
    for load in (0.2, 0.8):
        state = mf.equilibrium(made, load=load)
        force = surface.friction.shear_strength * surface.friction.area_ratio * state.area
        for i, area in enumerate(state.asperity_area):
            error = 2.8e-3 * math.sqrt(math.pi * area)
            x, y = surface.position[i]
            lines.append(f"{load:.2f}.tif,,{load},{force},{i + 1},{i},{x},{y},{area},{error},,,")
    Path("contacts.csv").write_text("\n".join(lines), "utf-8")


def test_a_tilt_is_explained_and_stored(run, tilted):
    result = run("compare", "linear", "contacts.csv", "--explain", "--json")
    assert result.exit_code == 0, result.output
    data = json.loads(result.stdout)["explanation"]
    assert (
        "measured values, the areas of the single contacts included; with the errors found"
        in data["answers"][0]
    )
    found = data["data"]
    assert found["group"]["values"][0] == "tilt"
    assert found["share"]["values"][0] > 0.8
    assert math.degrees(found["mean"]["values"][0]) == pytest.approx(0.1, abs=0.01)
    assert Path("linear/explained.nc").exists()
    options = ("--explain", "--force", "--height-sd", "0", "--radius-sd", "0", "--position-sd", "1um")
    text = run("compare", "linear", "contacts.csv", *options).output
    assert "What explains the measured law" in text
    assert "single heights" not in text
    assert "It is explained by tilt (" in text
    assert text.rstrip().endswith("wrote linear/explained.nc")


def test_a_stopped_explanation_leaves_no_file(run, tilted, monkeypatch):
    def stopped(*_args):
        raise mf.NotConverged("stopped")

    monkeypatch.setattr("metafem.calibration.explain", stopped)
    assert run("compare", "linear", "contacts.csv", "--explain").exit_code == 1
    assert not Path("linear/measured.nc").exists()


@pytest.mark.slow
def test_contacts_have_the_sites_of_a_design_that_leaves_some_empty(run, demo):
    demo("operating-points")
    design = mf.load("operating-points")
    assert design.surface.count < design.template.count
    lines = ["image,load_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2"]
    height = design.surface.height.copy()
    height[-1] -= 0.02
    for load in (0.2, 0.8):
        state = mf.equilibrium(design.surface.replaced(height=height), load=load)
        for i, area in enumerate(state.asperity_area):
            x, y = design.surface.position[i]
            error = 2.8e-3 * math.sqrt(math.pi * area)
            lines.append(f"{load},{load},{i + 1},{design.sites[i]},{x},{y},{area},{error}")
    Path("contacts.csv").write_text("\n".join(lines), "utf-8")
    result = run("compare", "operating-points", "contacts.csv", "--explain")
    assert result.exit_code == 0, result.output
    assert f"The asperity at site {design.sites[-1]} is" in result.output
    assert "lower than designed" in result.output


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--angle-sd", "0.1deg"), "--angle-sd needs --explain"),
        (("--explain", "--friction-sd", "3"), '--friction-sd = "3" needs a unit; write "3 %" or "300 %"'),
        (("--explain", "--angle-sd", "3"), "--angle-sd"),
        (("--explain", "--height-scale-sd", "90%"), "--height-scale-sd = 90 % must be at most"),
    ],
)
def test_wrong_options_are_named(run, tilted, options, message):
    result = run("compare", "linear", "contacts.csv", *options)
    assert result.exit_code == 2
    assert message in result.output
    assert not Path("linear/measured.nc").exists()
