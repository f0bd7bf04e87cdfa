"""The best common radius of a range or of a few tools."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus

LIMITS = mf.Limits(0.12, offset=0.05, height_sd=0.0009)
TOOLS = [0.8, 0.2, 0.526]


def test_a_law_of_one_tool_is_designed_with_it(template):
    """Six equal asperities of R carry A0 = pi R^(2/3) 6^(1/3) (3p/4)^(2/3), the most that N = 6 can."""
    six = mf.Surface.square_lattice(0.1, (2, 3), radius=1.0, material=mf.Material(1.36))
    load = np.linspace(0.01, 0.1, 8)
    law = mf.Independent().curve(six.replaced(radius=np.full(6, 0.4)), load)
    result = mf.design(
        mf.SampledLaw(load, law.area), six, limits=mf.Limits(0.5), radii=[0.3, 0.4, 0.5], common_radius=True
    )
    assert result.parameters["radius"] == 0.4
    assert result.misfit < 1e-3
    np.testing.assert_array_equal(result.surface.radius, 0.4)


def test_reach_of_each_tool_is_told(template):
    result = mf.design(mf.LinearLaw(7.0), template, limits=LIMITS, radii=TOOLS, common_radius=True)
    found = result.parameters
    assert found["tried_radii"].tolist() == sorted(TOOLS)
    assert found["radius"] in TOOLS
    assert result.misfit == found["radius_misfits"].min()
    for i, radius in enumerate(found["tried_radii"]):
        bounds = mf.achievable_friction_coefficients(template.replaced(radius=radius), LIMITS)
        assert (found["lowest_coefficients"][i], found["highest_coefficients"][i]) == bounds


def test_tools_out_of_reach_are_noted(template):
    """A slope below 3 pi/4 sqrt(R/h) asks for a smaller radius."""
    result = mf.design(mf.LinearLaw(4.5), template, limits=LIMITS, radii=TOOLS, common_radius=True)
    assert result.parameters["radius"] == 0.2
    assert (
        "radii that cannot reach the target [mm]: 0.526, 0.8; slope 4.5 is not above" in result.notes[-1].text
    )


def test_a_range_is_searched_around_its_best(template):
    target = mf.PowerLaw(1.2, (0.1, 0.4))
    result = mf.design(
        target, template, limits=mf.Limits(0.27), radii=mf.RadiusRange(0.3, 0.8), common_radius=True
    )
    assert len(result.parameters["tried_radii"]) > 7
    assert 0.3 <= result.parameters["radius"] <= 0.8
    assert result.status is DesignStatus.REACHED


def test_a_target_beyond_all_radii_says_why(template):
    with pytest.raises(
        mf.Infeasible, match=r"no radius .* of 0.2 mm, slope 1 .* of 0.8 mm, slope 1"
    ) as caught:
        mf.design(mf.LinearLaw(1.0), template, limits=LIMITS, radii=TOOLS, common_radius=True)
    near = mf.design(caught.value.nearest, template, limits=LIMITS, radii=TOOLS, common_radius=True)
    assert near.parameters["radius"] == 0.2


@pytest.mark.parametrize(
    ("radii", "words"),
    [
        ([], "radii"),
        ([0.3, -0.1], "radii holds -0.1; all must be greater than 0"),
        ([0.3, np.nan], "radii"),
    ],
)
def test_bad_radii_are_named(template, radii, words):
    with pytest.raises(mf.InvalidInput, match=words):
        mf.design(mf.LinearLaw(7.0), template, radii=radii, common_radius=True)


def test_a_range_must_increase():
    with pytest.raises(mf.InvalidInput, match=r"high = 0\.2 must be greater than 0\.3"):
        mf.RadiusRange(0.3, 0.2)
