"""A refused bilinear law states ranges of the crossover load and of the second slope that can be met."""

import re

import pytest

import metafem as mf

LIMITS = mf.Limits(0.12)
NUMBER = r"([\d.e-]+)"


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize(
    ("slopes", "crossover"),
    [((7.15, 12.0), 5.0), ((7.15, 12.0), 0.4), ((7.15, 12.52), 1e-4), ((7.15, 5.0), 0.4)],
)
def test_the_crossovers_that_are_offered_can_be_designed(template, slopes, crossover, friction):
    factor = template.material.composite_modulus if friction else 1.0
    target = mf.BilinearLaw(slopes, crossover)
    if friction:
        pair = template.material, template.friction
        per_slope = mf.LinearLaw.from_friction_coefficient(1.0, *pair).slope
        coefficients = [slope / per_slope for slope in slopes]
        target = mf.BilinearLaw.from_friction_coefficients(coefficients, factor * crossover, *pair)
    with pytest.raises(mf.Infeasible) as caught:
        mf.design(target, template, limits=LIMITS)
    unit = "N" if friction else r"mm\^2"
    words = rf"with these slopes.* from {NUMBER} to {NUMBER} {unit}"
    ends = [float(end) / factor for end in re.search(words, str(caught.value)).groups()]
    assert not ends[0] < crossover < ends[1]
    for load in ends:
        design = mf.design(mf.BilinearLaw(target.slopes, load), template, limits=LIMITS)
        assert design.density.asymptotic_slopes(0.526) == pytest.approx(target.slopes, rel=1e-6)
        assert design.density.crossover_load(64, 0.526) == pytest.approx(load, rel=1e-6)
    assert mf.design(caught.value.nearest, template, limits=LIMITS).density is not None


@pytest.mark.parametrize(("second", "crossover"), [(1.0, 5.0), (500.0, 0.01), (12.0, 0.4)])
def test_the_second_slopes_that_are_offered_can_be_designed(template, second, crossover):
    with pytest.raises(mf.Infeasible) as caught:
        mf.design(mf.BilinearLaw((7.15, second), crossover), template, limits=LIMITS)
    ends = re.search(rf"second slope.*? from {NUMBER} to {NUMBER}", str(caught.value)).groups()
    other = re.search(rf"it can be {NUMBER} mm", str(caught.value))
    load = float(other[1]) if other else crossover
    for slope in map(float, ends):
        assert mf.design(mf.BilinearLaw((7.15, slope), load), template, limits=LIMITS).density is not None
