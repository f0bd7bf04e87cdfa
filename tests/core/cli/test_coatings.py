"""Friction that differs from asperity to asperity, on the command line."""

from pathlib import Path

import pytest

TABLE = (
    "x_mm,y_mm,height_um,radius_um,shear_strength_MPa,area_ratio\n0,0,120,526,0.4,0.9\n1.5,0,120,526,0.1,1\n"
)


def test_a_table_with_two_frictions_is_predicted(run):
    Path("h.csv").write_text(TABLE, "utf-8")
    options = ("--composite-modulus", "1.36 MPa", "--load", "0.1 N")
    found = run("predict", "h.csv", *options, "--onset", "0.1 N", "--json").data
    force = (0.36 + 0.1) * 0.5 * found["area_mm2"][0]
    assert found["friction_force_N"] == pytest.approx([force], rel=1e-12)
    assert found["friction_coefficient"] == pytest.approx([force / 0.1], rel=1e-12)
    assert found["onset"]["friction_force_N"][-1] == pytest.approx(force, rel=1e-12)
    assert "F/P" in run("predict", "h.csv", *options).output
    assert run("predict", "h.csv", *options, "-o", "law.csv").exit_code == 0
    header, row = Path("law.csv").read_text("utf-8").splitlines()
    law = dict(zip(header.split(","), map(float, row.split(",")), strict=True))
    assert law["rescaled_friction_mm2"] == pytest.approx(force / 0.36, rel=1e-12)
    assert (
        "h.csv has a column shear_strength, and --shear-strength is given too"
        in run("predict", "h.csv", *options, "--shear-strength", "0.4 MPa").refusal
    )
