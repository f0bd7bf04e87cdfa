"""`metafem compare`, its explanation, and the section of the report on the measured law."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.files.images import contacts_table
from tests.calibration.contacts import table_of


@pytest.fixture
def measured(demo):
    """Write a measured table of the demo "linear": 3 % more friction than designed."""
    demo("linear")
    design = mf.load("linear")
    load = np.linspace(0.05, 0.9, 10)
    force = 1.03 * mf.friction_law(design.surface, load=load).friction_force
    lines = [f"{1e3 * p:.3f},{1e3 * f:.4f}" for p, f in zip(load, force, strict=True)]
    Path("measured.csv").write_text("\n".join(["load_mN,friction_force_mN", *lines]), "utf-8")


def test_a_measured_law_is_compared_and_stored(run, measured):
    data = run("compare", "linear", "measured.csv", "--json").data
    np.testing.assert_allclose(np.array(data["data_vars"]["deviation"]["data"])
                               / data["data_vars"]["predicted"]["data"], 0.03, atol=1e-4)  # fmt: skip
    assert data["answer"].startswith("The measured law does not agree with the design")
    assert Path("linear/measured.nc").exists()
    again = run("compare", "linear", "measured.csv")
    assert "measured.nc exists; choose another name, or replace it with force=True (--force)" in again.refusal
    text = run("compare", "linear", "measured.csv", "--force").words
    assert "+3.0 %" in text
    assert "measured F [N]" in text
    assert "(rejected at 1 %): rms deviation 3 %" in text
    assert text.endswith("wrote linear/measured.nc")
    assert run("report", "linear").exit_code == 0
    report = Path("linear/report.html").read_text("utf-8")
    assert ">Measured law</h2>" in report
    assert "rms deviation 3 %" in report


def test_a_calibration_gives_the_material_pair_with_its_errors(run, measured):
    calibration = {
        "parameters": ["composite_modulus", "area_ratio", "shear_strength"],
        "values": [1.36, 0.85, 0.358 * 1.03], "matrix": np.diag([0.04**2, 0.01**2, 0.006**2]).tolist(),
    }  # fmt: skip
    lines = ["[covariance]", *(f"{name} = {json.dumps(value)}" for name, value in calibration.items())]
    Path("calibration.toml").write_text("\n".join(lines), "utf-8")
    data = run("compare", "linear", "measured.csv", "--calibration", "calibration.toml", "--json").data
    assert data["parameters"] == "composite_modulus area_ratio shear_strength"
    ratio = np.array(data["data_vars"]["deviation"]["data"]) / data["data_vars"]["predicted"]["data"]
    np.testing.assert_allclose(ratio, 0.0, atol=1e-4)
    options = ("--calibration", "calibration.toml", "--json", "--force")
    alone = run("compare", "linear", "measured.csv", "--shear-strength", "0.358 MPa", *options).data
    assert alone["parameters"] == "composite_modulus area_ratio"  # a stated strength is exact
    # 3 % more friction is less than two standard deviations of sigma and B
    assert alone["data_vars"]["chi_square"]["data"] < alone["data_vars"]["freedom"]["data"] == 10


def write_contacts(design, made):
    """Write the table of the contacts of a made surface at two loads."""
    load, surface = np.array([0.2, 0.8]), design.surface
    area = np.array([mf.equilibrium(made, design.law.model, load=each).asperity_area for each in load])
    friction = surface.friction
    force = friction.shear_strength * friction.area_ratio * area.sum(axis=1)
    table = table_of(
        *(("0.20.tif", "0.80.tif"), ("", ""), load, force, surface.position, design.sites, True),
        *(area, 2.8e-3 * np.sqrt(math.pi * area), np.nan * area, np.nan * area),
    )
    Path("contacts.csv").write_text(contacts_table(table), "utf-8")


@pytest.fixture
def tilted(demo):
    """Write the table of the contacts of the demo "linear", tilted by 0.1 degrees."""
    demo("linear")
    design = mf.load("linear")
    write_contacts(design, design.surface.tilted(math.radians(0.1), 0.0))


def test_a_tilt_is_explained_and_stored(run, tilted):
    data = run("compare", "linear", "contacts.csv", "--explain", "--json").data["explanation"]
    found = data["data_vars"]
    assert data["coords"]["cause"]["data"][0] == "angle_x"
    assert math.degrees(found["mean"]["data"][0]) == pytest.approx(0.1, abs=0.01)
    assert Path("linear/explained.nc").exists()
    options = ("--explain", "--force")
    text = run("compare", "linear", "contacts.csv", *options).output
    assert "tilt along x" in text
    assert text.rstrip().endswith("wrote linear/explained.nc")
