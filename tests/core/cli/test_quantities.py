"""Quantities on the command line: `predict --quantities`, and a specification of a stiffness."""

from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.files import demo_text

REST = demo_text("linear").split("[material]")[1].replace('height_step = "6 um"', "")
STIFFNESS = 'kind = "power"\nof = "stiffness"\nexponent = 0.5\nload_range = ["0.05 mm^2", "0.2 mm^2"]\n'

pytestmark = pytest.mark.usefixtures("plain_reports")


def test_quantities_are_those_of_the_package(run):
    Path("heights.csv").write_text("x_mm,y_mm,height_um,radius_um\n0,0,100,526\n1.5,0,110,526\n")
    shared = ("heights.csv", "--composite-modulus", "1.36 MPa", "--load", "0.05 N", "--quantities")
    both = run("predict", *shared, "--model", "independent", "--model", "half-space", "--json")
    surface = mf.files.read_surface("heights.csv", mf.Material(1.36))
    for law, model in zip(both.data["laws"], (mf.Independent(), mf.Interacting()), strict=True):
        conducts = mf.conductance(surface, model, load=[0.05], resistivity=1.0)
        assert law["rescaled_conductance_mm"] == pytest.approx(conducts.rescaled_conductance, rel=1e-12)
        tangential = mf.tangential_stiffness(surface, model, load=[0.05])
        assert law["tangential_stiffness_N_per_mm"] == pytest.approx(tangential, rel=1e-12)
    for model in ((), ("--model", "automatic")):
        assert "rescaled conductance [mm]" in run("predict", *shared, *model).told


def test_a_stiffness_is_designed(run):
    Path("spec.toml").write_text(f"[target]\n{STIFFNESS}[material]{REST}")
    assert run("design", "spec.toml", "-o", "part", "--json").data["misfit"] < 0.01
    design = mf.load("part")
    assert design.target == mf.PowerLaw(0.5, (0.05, 0.2), of="stiffness")
    load = np.geomspace(0.05, 0.2, 10)
    stiffness = mf.friction_law(design.surface, load=1.36 * load).rescaled_stiffness
    assert np.polyfit(np.log(load), np.log(stiffness), 1)[0] == pytest.approx(0.5, abs=0.02)


def test_a_refused_stiffness_writes_no_table_of_friction(run):
    refused_law = STIFFNESS.replace("exponent = 0.5", "exponent = 0.2")
    Path("spec.toml").write_text(f"[target]\n{refused_law}[material]{REST}")
    refused = run("design", "spec.toml", "-o", "part", "--json").missed
    assert "at least 0.3333" in refused["error"]["message"]
    assert not list(Path().glob("*.csv"))
