"""The key `of` of the section [target]."""

import pytest

import metafem as mf

REST = """
[material]
composite_modulus = "1.36 MPa"
poisson_ratio = 0.5
[friction]
shear_strength = "0.4 MPa"
[lattice]
radius = "0.526 mm"
shape = [8, 8]
pitch = "1.5 mm"
[limits]
max_height = "0.12 mm"
"""
POINTS = 'rescaled_load = ["0.1 mm^2", "0.2 mm^2"]\n'


def read(folder, target):
    path = folder / "spec.toml"
    path.write_text("[target]\n" + target + REST)
    return mf.read_spec(path).target


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            'kind = "sampled"\nof = "stiffness"\n' + POINTS + 'rescaled_friction = ["3.5 mm", "5.1 mm"]',
            mf.SampledLaw([0.1, 0.2], [3.5, 5.1], of="stiffness"),
        ),
        (
            'kind = "operating-points"\nof = "conductance"\n'
            + POINTS
            + 'rescaled_friction = ["3.5 mm", "5.1 mm"]',
            mf.OperatingPoints([0.1, 0.2], [3.5, 5.1], of="conductance"),
        ),
        (
            'kind = "band"\nof = "stiffness"\n'
            + POINTS
            + 'lowest = ["3.5 mm", "5 mm"]\nhighest = ["4 mm", "6 mm"]',
            mf.Band([0.1, 0.2], [3.5, 5.0], [4.0, 6.0], of="stiffness"),
        ),
        (
            'kind = "power"\nof = "tangential_stiffness"\nexponent = 0.6\n'
            'load_range = ["0.1 mm^2", "0.2 mm^2"]',
            mf.PowerLaw(0.6, (0.1, 0.2), of="tangential_stiffness"),
        ),
        (
            'kind = "linear"\nof = "stiffness"\nslope = 20.0\nload_range = ["0.1 mm^2", "0.2 mm^2"]',
            mf.LinearLaw(20.0, (0.1, 0.2), of="stiffness"),
        ),
    ],
)
def test_targets_of_quantities(text, expected, tmp_path):
    assert read(tmp_path, text) == expected


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            'kind = "sampled"\nof = "stiffness"\n' + POINTS + 'rescaled_friction = ["3.5 mm^2", "5.1 mm^2"]',
            "in mm",
        ),
        ('kind = "sampled"\n' + POINTS + 'rescaled_friction = ["3.5 mm", "5.1 mm"]', r"in mm\^2"),
        ('kind = "linear"\nof = "stiffness"\nfriction_coefficient = 1.5', "cannot be combined"),
        ('kind = "linear"\nof = "stiffness"\nslope = 20.0', "load_range"),
        ('kind = "linear"\nof = "heat"\nslope = 20.0', "of"),
    ],
)
def test_contradictions_are_refused(text, words, tmp_path):
    with pytest.raises(mf.InvalidInput, match=words):
        read(tmp_path, text)
