"""`metafem calibrate` on exact and noisy tables, and the study that takes its covariance."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasurementErrors
from metafem.files.images import contacts_table
from tests.calibration.contacts import table_of

A = np.linspace(0.08, 0.4, 20)
AREA = 5.0 * math.pi * A**2
LOAD = 5.0 * (1.36 * 4.0 / 3.0 * A**3 / 0.526 - np.sqrt(8.0 * math.pi * 3e-5 * 1.36 * A**3))
RADIUS = ("--contacts", 5, "--radius", "526 um", "--radius-sd", "5 um", "--column", "load=Kraft [mN]")


def table(name, header, *columns):
    """Write a table."""
    rows = zip(*(np.asarray(column).tolist() for column in columns), strict=True)
    lines = [",".join(map(str, row)) for row in rows]
    Path(name).write_text("\n".join([header, *lines]), "utf-8")


@pytest.fixture
def tables(run):
    """Write a compression and a shear table of exact points."""
    table("compression.csv", "Kraft [mN],area_mm2", 1e3 * LOAD, AREA)
    table("shear.csv", "area_before_mm2,area_sheared_mm2,friction_force_mN", AREA, 0.85 * AREA, 314.5 * AREA)


def test_all_parameters_are_printed_and_written(run, tables):
    files = ("-o", "calibration.toml")
    text = run("calibrate", "compression.csv", "shear.csv", *RADIUS, *files).told
    for part in ("E*, composite modulus 1.360", "w, adhesion energy 30", "B, area ratio 0.8500"):
        assert part in text
    assert "σ, shear strength 0.3700" in text
    assert "E* and w: the law fits" in text
    assert text.endswith("wrote calibration.toml")
    assert "would fit" not in text
    block = tomllib.loads(Path("calibration.toml").read_text("utf-8"))
    assert list(block) == ["material", "contact", "friction", "covariance"]
    assert block["covariance"]["values"] == pytest.approx([0.526, 1.36, 0.85, 0.37])
    data = run("calibrate", "compression.csv", "shear.csv", *RADIUS, "--json").data
    pressed = data["compression"]
    assert data["covariance"] == block["covariance"]
    assert pressed["adhesion_energy_N_per_mm"] == pytest.approx(3e-5)
    # the numbers are those of the Python functions
    exact = mf.calibration.fit_compression(
        LOAD, AREA, 0.526, contacts=5, errors=MeasurementErrors(radius_sd=0.005)
    )
    for name, unit in (("composite_modulus", "MPa"), ("adhesion_energy", "N_per_mm")):
        assert pressed[f"{name}_interval_{unit}"] == pytest.approx(exact.estimates[name].interval)
    sheared = mf.calibration.shear(AREA, 0.85 * AREA, 0.3145 * AREA)
    names, covariance = mf.calibration.joint_covariance(exact, sheared)
    assert block["covariance"]["parameters"] == list(names)
    np.testing.assert_allclose(block["covariance"]["matrix"], covariance, rtol=1e-5)


@pytest.mark.slow
def test_tests_are_compared(run, tables):
    Path("second.csv").write_bytes(Path("shear.csv").read_bytes())
    arguments = ("calibrate", "shear.csv", "second.csv")
    assert "the tests agree" in run(*arguments).told
    data = run(*arguments, "--json").data
    assert data["covariance"]["parameters"] == ["area_ratio", "shear_strength"]


def test_errors_are_those_of_the_options(run, tables):
    options = ("--load-error", "1 mN", "--boundary-error", "3 um", "--friction-error", "2 mN")
    options += ("--friction-relative-error", "2 %")
    data = run("calibrate", "shear.csv", *options, "--json").data
    errors = MeasurementErrors(1e-3, 3e-3, 2e-3, 0.02)
    expected = mf.calibration.shear(AREA, 0.85 * AREA, 0.3145 * AREA, errors=errors)
    np.testing.assert_allclose(data["covariance"]["matrix"], expected.covariance, rtol=1e-6)


def contacts():
    """Return the contacts of five caps in images of a compression and shear test."""
    area = np.repeat(AREA[:, None] / 5.0, 5, axis=1)
    corner = 5.05 * np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
    images, error = tuple(f"{i}.tif" for i in range(20)), 1e-3 * np.sqrt(math.pi * area)
    return table_of(
        *(images, ("",) * 20, LOAD, 0.3145 * AREA, corner, np.arange(5), False),
        *(area, error, 0.85 * area, error),
    )


def test_contacts_in_images_are_calibrated_one_by_one(run):
    Path("contacts.csv").write_text(contacts_table(contacts()), "utf-8")
    data = run("calibrate", "contacts.csv", "--radius", "526 um", "--json").data
    assert data["covariance"]["values"] == pytest.approx([1.36, 0.85, 0.37])
    # the error of the boundary is that of the table
    expected = mf.calibration.shear(
        AREA, 0.85 * AREA, 0.3145 * AREA, errors=MeasurementErrors(boundary=0.5e-3)
    )
    matrix = np.array(data["covariance"]["matrix"])
    np.testing.assert_allclose(matrix[1:, 1:], expected.covariance, rtol=1e-6)


@pytest.mark.slow
def test_the_covariance_is_handed_on_to_the_study(run, demo, tables):
    demo("linear")
    run("calibrate", "compression.csv", "shear.csv", *RADIUS, "-o", "calibration.toml")
    options = ("--calibration", "calibration.toml", "--draws", 512, "--json")
    data = run("study", "uncertainty", "linear", "--load-sd", "2mN", *options).data
    parameters = data["coords"]["parameter"]["data"]
    assert parameters == ["radius + composite_modulus", "area_ratio + shear_strength", "load"]
    assert (
        "two options give the error of radius"
        in run("study", "uncertainty", "linear", "--radius-sd", "2um", *options, "--force").refusal
    )
