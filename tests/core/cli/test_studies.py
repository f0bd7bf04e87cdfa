"""Studies of a result folder: what they print and write, and what they refuse."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import metafem as mf
from metafem.files import demo_text


@pytest.mark.usefixtures("plain_reports")
def test_study_prints_its_table_and_keeps_its_file(run):
    text = demo_text("linear").replace("[8, 8]", "[3, 3]").replace('height_step = "6 um"', "")
    Path("small.toml").write_text(text, "utf-8")
    assert run("design", "small.toml", "-o", "small").exit_code == 0
    result = run("study", "interaction", "small", "--assignments", 20)
    assert "half-space" in result.told
    assert "…" not in result.stdout  # on the other stream kernels may be compiled
    assert "--force" in run("study", "interaction", "small").refusal
    data = run("study", "interaction", "small", "--assignments", 20, "--force", "--json").data
    with xr.open_dataset("small/interaction.nc", engine="h5netcdf") as kept:
        assert kept.area_change.values.tolist() == data["data_vars"]["area_change"]["data"]
        assert kept.sinking.attrs["units"] == "mm"


STUDIES = {
    "manufacturing": ("--height-sd", "1um,3um,5um", "--angle", "0.01deg", "--misfit", "--draws", 200),
    "misalignment": ("--angle", "0.1deg", "--assignments", 3),
    "uncertainty": ("--composite-modulus-sd", "0.04MPa", "--radius-sd", "2 um", "--draws", 200),
}
ANSWERS = {
    "manufacturing": "With errors of the heights of up to 3.",
    "misalignment": "With tilts within ±0.0",
    "uncertainty": "The composite modulus E* matters most: its error accounts for 9",
}


@pytest.mark.slow
def test_the_report_holds_the_answers_of_all_studies(run, demo):
    demo("linear")
    answers = []
    for name, options in STUDIES.items():
        lines = run("study", name, "linear", *options).ended(0).stdout.splitlines()
        answers += [line for line in lines if line.startswith(ANSWERS[name])]
    assert len(answers) == len(STUDIES)
    assert run("report", "linear").exit_code == 0
    report = Path("linear/report.html").read_text("utf-8")
    assert all(answer in report for answer in answers)
    assert "the source paper does not print the range" in report
    with xr.open_dataset("linear/manufacturing.nc", engine="h5netcdf") as kept:
        assert kept.height_sd.values.tolist() == [0.001, 0.003, 0.005]
        assert kept.attrs["draws"] >= 200


@pytest.mark.slow
def test_a_study_takes_model_and_loads(run, demo):
    demo("linear")
    options = ("--model", "layer", "--load-range", "0.2N", "0.5N", "--angle", "0.2deg")
    data = run("study", "misalignment", "linear", *options, "--assignments", 0, "--json").data
    assert data["model"].startswith("Interacting(")
    assert data["load_range"] == pytest.approx([0.2 / 1.36, 0.5 / 1.36])
    assert mf.load("linear").law.model == mf.Independent()


def test_a_surface_of_one_height_needs_a_range_of_loads(run, demo):
    demo("linear")
    design = mf.load("linear")
    flat = design.surface.replaced(height=np.full(64, 0.2))
    law = mf.friction_law(flat, load=design.law.load)
    mf.save(replace(design, surface=flat, law=law), "flat")
    assert "--load-range must be given" in run("study", "manufacturing", "flat", "--draws", 8).refusal
    assert run("study", "manufacturing", "flat", "--draws", 8, "--load-range", "0.1N", "0.2N").exit_code == 0
