"""Sections of a specification that a calibration writes, read back inside a whole one."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import fit_compression, shear
from metafem.files import block_text, demo_text
from metafem.files.atomic import MARKS

A = np.linspace(0.08, 0.4, 20)
AREA = math.pi * A**2
ROOT = math.sqrt(8.0 * math.pi)
SHEARED = shear(AREA, 0.85 * AREA, 0.3145 * AREA)


def pressed(energy, **options):
    """Return the calibration of exact points with an adhesion energy [N/mm]."""
    load = 1.36 * 4.0 / 3.0 * A**3 / 0.526 - ROOT * math.sqrt(energy * 1.36) * A**1.5
    return fit_compression(load, AREA, 0.526, **options)


def read_back(text, tmp_path):
    """Return the specification of a demo with these sections in place of its own."""
    sections = {}
    for part in demo_text("linear").split("\n["):
        sections[part.partition("]")[0].lstrip("[")] = part
    for name in tomllib.loads(text):
        sections.pop(name, None)
    rest = "\n[".join(sections.values())
    path = Path(tmp_path, "spec.toml")
    path.write_text(f"{rest}\n{text}", "utf-8")
    return mf.read_spec(path)


def test_the_sections_are_read_back_in_a_specification(tmp_path):
    found = pressed(5e-4)
    text = block_text(found, SHEARED, ["a.csv", "b.csv"])
    assert text.encode().startswith(MARKS["sections"])
    spec = read_back(text, tmp_path)
    # as many digits as the standard deviations allow
    assert spec.template.material.composite_modulus == pytest.approx(1.36, abs=0.01 * 0.06)
    assert spec.template.friction.shear_strength == pytest.approx(0.37, abs=1e-4)
    assert spec.template.friction.area_ratio == pytest.approx(0.85, abs=1e-4)
    assert spec.model.contact.adhesion_energy == pytest.approx(5e-4, rel=0.02)
    assert "# Measured: a.csv" in text


@pytest.mark.parametrize(
    ("words", "cap"),
    [("sphere", mf.SphericalCap()), ("power 4 0.5", mf.PowerCap(4.0, 0.5)), ("hertz", mf.Hertz())],
)
def test_caps_are_read_back(words, cap, tmp_path):
    spec = read_back(block_text(pressed(5e-4), None, ["a.csv"], words), tmp_path)
    assert spec.model.contact.cap == cap


def test_a_table_of_a_cap_stays_named():
    text = block_text(pressed(5e-4), None, ["a.csv"], "profile cap.csv")
    assert tomllib.loads(text)["contact"]["cap"] == {"kind": "profile", "file": "cap.csv"}


def test_without_adhesion_the_modulus_is_that_of_no_adhesion(tmp_path):
    rising = pressed(1e-5)
    load = 2.0 * 1.36 * 4.0 / 3.0 * A**3 / 0.526 - rising.load  # on the other side of the law
    found = fit_compression(load, AREA, 0.526)
    assert found.adhesion_energy == 0.0
    spec = read_back(block_text(found, None, ["a.csv"]), tmp_path)
    assert spec.model.contact == mf.Hertz()
    modulus, sd = found.modulus_without_adhesion
    assert spec.template.material.composite_modulus == pytest.approx(modulus, abs=0.01 * sd)


def test_adhesion_that_may_be_none_is_told():
    text = block_text(pressed(1e-7), None, ["a.csv"])
    assert 'kind = "jkr"' in text
    assert '# The data do not show adhesion; without it, kind = "hertz"' in text


def test_friction_alone_and_lines_that_do_not_fit():
    text = block_text(None, shear(AREA, 0.85 * AREA, 0.3145 * AREA + 0.01), ["a.csv"])
    assert list(tomllib.loads(text)) == ["friction"]
    assert "the line does not fit" in text
