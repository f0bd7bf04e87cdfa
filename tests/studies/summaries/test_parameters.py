"""Which input matters most, in words."""

import metafem as mf
from metafem.studies import summary


def test_the_input_with_the_largest_share_is_named(template):
    inputs = {"composite_modulus": 0.04, "radius": 0.002}
    found = summary(mf.studies.uncertainty(template, inputs, draws=500, load=[0.3]))
    assert found.answer.startswith("The composite modulus E* matters most: its error accounts for 9")
    assert [row[0] for row in found.rows] == ["composite modulus E*", "radius R"]


def test_correlated_inputs_are_named_together(template):
    inputs, covariance = ["composite_modulus", "radius"], [[1.6e-3, 4e-5], [4e-5, 4e-6]]
    found = summary(mf.studies.uncertainty(template, (inputs, covariance), draws=500, load=[0.3]))
    assert found.answer.startswith(
        "The composite modulus E* and the radius R matter most: their errors account for 100 %"
    )
