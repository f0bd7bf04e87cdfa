"""What each command refuses, with the key and the value that its message holds, and its exit code."""

from pathlib import Path

import pytest

from metafem import cli
from metafem.errors import spoken
from metafem.files import demo_text

LINEAR = demo_text("linear")

# A specification with one change; what the message holds; the exit code.
SPECIFICATIONS = [
    ("slope = 6.87", "slope = 3.0", ("slope", "3"), 1),
    ("slope = 6.87", "friction_coefficient = 0.9", ("friction coefficient", "0.9"), 1),
    ('"120 um"', "120", ("limits.max_height", "120"), 2),
    ("[target]", "[target", ("line",), 2),
    ('kind = "linear"', 'kind = "linar"', ("target.kind", "linar"), 2),
]

TABLE = ("predict", "h.csv", "--composite-modulus", "1.36 MPa")
BARE = ("predict", "bare.csv", "--composite-modulus", "1 MPa")
STUDY = ("study", "uncertainty", "linear")
COMPARE = ("compare", "linear", "measured.csv")
RADIUS = ("--contacts", "5", "--radius", "526 um")

# A call, the key and the value.
REFUSALS = [
    (("predict", "none.csv"), "none.csv", "no such file"),
    (("predict", "h.csv"), "composite_modulus", "young_modulus"),
    ((*TABLE, "--young-modulus", "1 MPa"), "composite_modulus", "young_modulus"),
    ((*TABLE, "--area-ratio", "0.85"), "--shear-strength", "is missing"),
    (("predict", "linear", "--poisson-ratio", "0.3"), "--poisson-ratio", "tables"),
    (("predict", "empty.csv", *TABLE[2:]), "empty.csv", "empty"),
    (("predict", "linear.toml"), "linear.toml", "specification"),
    (("report", "."), ".", "result folder"),
    ((*BARE, "--radius", "-5 um"), "--radius", "-5 um"),
    ((*BARE, "--radius", "1,5 mm"), "--radius", "1,5 mm"),
    ((*BARE[:3], "-1 kPa"), "--composite-modulus", "-1 kPa"),
    ((*TABLE, "--model", "resolved", "--contact", "jkr 9 mJ/m^2"), "contact", "JKR("),
    (("design", "linear.toml", "-o", ""), "no result folder", "in the way"),
    (("design", "none.toml", "-o", "x"), "none.toml", "no such file"),
    (("design", "linear.toml", "-o", "no/where"), "no", "not a folder"),
    (("design", "bare.toml", "-o", "x", "--model", "layer"), "layer", "[block]"),
    (("study", "misalignment", "linear", "--angle", "50deg"), "--angle", "50deg"),
    (("study", "misalignment", "linear", "--load-range", "0.5N", "0.2N"), "--load-range[1]", "0.2N"),
    (("study", "manufacturing", "linear", "--height-sd", "-3um"), "--height-sd", "-3um"),
    (("study", "manufacturing", "linear", "--position-sd", "1N"), "--position-sd", "1N"),
    (("study", "manufacturing", "linear", "--radius-sd", "100um"), "--radius-sd", "100um"),
    (STUDY, "--radius-sd", "no error"),
    ((*STUDY, "--radius-sd", "2MPa"), "--radius-sd", "2MPa"),
    ((*STUDY, "--composite-modulus-sd", "1MPa"), "--composite-modulus-sd", "1MPa"),
    ((*STUDY, "--area-ratio-sd", "1%"), "--area-ratio-sd", "1%"),
    (("study", "uncertainty", "linear", "--calibration", "measured.csv"), "measured.csv", "calibration"),
    ((*COMPARE, "--shear-strength", "1.4"), "--shear-strength", "1.4"),
    ((*COMPARE, "--shear-strength", "-1 MPa"), "--shear-strength", "-1"),
    (("calibrate",), "table", "calibrate"),
    (("calibrate", "compression.csv"), "--radius", "E*"),
    (("calibrate", "compression.csv", "--radius", "-1 mm"), "--radius", "-1 mm"),
    (("calibrate", "shear.csv", "--load-error", "5 mm"), "--load-error", "5 mm"),
    (("calibrate", "shear.csv", "--friction-relative-error", "3"), "--friction-relative-error", "3"),
    (("calibrate", "shear.csv", "-o", "a.txt"), "a.txt", ".toml"),
    (("calibrate", "negative.csv", *RADIUS), "negative.csv, line 3", "-1"),
    (("images", "part.txt", "--pixel", "5 um", "--picture", "made.pdf"), "made.pdf", ".svg"),
    (("images", "nosuchfolder", "--pixel", "5 um"), "nosuchfolder", "no such file"),
    (("images", "part.txt"), "--pixel", "Missing option"),
]  # fmt: skip


def table(name, header, *rows):
    """Write a table."""
    Path(name).write_text("\n".join([header, *rows]) + "\n", "utf-8")


def refused(result, *words):
    """Whether a message holds all of some words."""
    text = result.words
    return [word for word in words if spoken(word) not in text] == [] or text


@pytest.mark.parametrize(("old", "new", "words", "code"), SPECIFICATIONS)
def test_a_specification_is_refused_and_leaves_no_folder(run, old, new, words, code):
    assert old in LINEAR
    Path("bad.toml").write_text(LINEAR.replace(old, new), "utf-8")
    result = run("design", "bad.toml", "-o", "bad")
    assert (result.exit_code, refused(result, *words)) == (code, True)
    assert [path.name for path in Path().iterdir()] == ["bad.toml"]


@pytest.mark.parametrize(("arguments", "key", "value"), REFUSALS)
def test_a_call_is_refused_by_its_key_and_value(run, demo, arguments, key, value):
    demo("linear")
    start, end = LINEAR.index("[block]"), LINEAR.index("[limits]")
    Path("bare.toml").write_text(LINEAR[:start] + LINEAR[end:], "utf-8")
    table("h.csv", "x_mm,y_mm,height_um,radius_um", "0,0,120,526")
    table("bare.csv", "x_mm,y_mm,height_um", "0,0,5")
    table("measured.csv", "load_N,friction_force_N", "0.1,0.2", "0.3,0.5")
    table("compression.csv", "load_mN,area_mm2", "10,1", "20,2", "30,3")
    table("negative.csv", "load_mN,area_mm2", "30,1", "20,-1", "10,3")
    table(
        "shear.csv", "load_N,area_before_mm2,area_sheared_mm2,friction_force_N",
        "0.1,0.5,0.42,0.16", "0.2,0.8,0.68,0.26",
    )  # fmt: skip
    Path("empty.csv").touch()
    Path("part.txt").touch()
    before = sorted(path for path in Path().rglob("*"))
    result = run(*arguments)
    assert (result.exit_code, refused(result, key, value)) == (2, True)
    assert sorted(path for path in Path().rglob("*")) == before


def test_every_command_has_help(run):
    names = cli.main.list_commands(None)
    studies = [("study", name) for name in cli.main.get_command(None, "study").list_commands(None)]
    for command in [(), *((name,) for name in names), *studies]:
        assert "Usage:" in run(*command, "--help").told, command
