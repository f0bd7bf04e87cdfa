"""Targets that no surface reaches are refused with the bound, and with the nearest target that one does."""

import pytest

import metafem as mf
from metafem.inversion import achievable_load_range
from tests.models.scenes import Cone

LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.4))
HIGH, TALL, LOW = mf.Limits(0.3), mf.Limits(0.27), mf.Limits(0.12, offset=0.05)
PAIR = LATTICE.material, LATTICE.friction
TOOLS, RANGE = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4))], mf.PowerRange(1.2, 6.0)
ONE = LATTICE.only(slice(1))
FEW = dict.fromkeys(range(62))


def after(second, third):
    """Return three operating points with some frictions of the last two."""
    return mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, second, third])


def coefficients(*mu):
    return mf.BilinearLaw.from_friction_coefficients(mu, 0.05168, *PAIR)


def under(contact, template=LATTICE):
    return {"model": mf.Independent(contact=contact), "template": template}


# The target, its limits, other arguments, and words of the error: where the bound lies, and what it is.
BOUNDS = [
    (after(1.68, 9.0), TALL, {}, ("point 3", "927")),
    (after(1.0, 4.0), TALL, {}, ("point 2", "1.48208 to 2.80861")),
    (mf.OperatingPoints([0.0001], [1e-4]), TALL, {}, ("point 1", "single asperity")),
    (mf.LinearLaw(3.0), LOW, {}, ("slope 3", "4.93303")),
    (mf.LinearLaw.from_friction_coefficient(0.9, *PAIR), LOW, {}, ("friction coefficient 0.9", "1.45")),
    (mf.LinearLaw(1e3), LOW, under(mf.Elastic(mf.Power(1.1, 0.3))), ("slope 1000", "contact law")),
    (mf.LinearLaw(1.0), HIGH, {"tools": [0.2, 0.8]}, ("0.2 mm", "0.8 mm")),
    (mf.BilinearLaw((7.15, 12.0), 5.0), LOW, {}, ("crossover_load = 5", "0.4354")),
    (mf.BilinearLaw((7.15, 12.0), 0.4), LOW, {}, ("second slope", "7.78")),
    (coefficients(1.6, 90.0), LOW, {}, ("friction_coefficients[1] = 90", "0.05168 N")),
    (mf.LinearLaw(7.0, (0.01, 0.2)), TALL, {}, ("0.01 mm", "0.01407")),
    (mf.LinearLaw(7.0, (0.03, 0.7)), TALL, {}, ("0.7 mm", "0.6002")),
    (mf.BilinearLaw((6.0, 9.0), 0.08, (0.03, 0.7)), TALL, {}, ("slope 9 from 0.08", "0.3336")),
    (mf.BilinearLaw((6.0, 3.9), 0.08, (0.04, 0.2)), TALL, {}, ("slope 3.9", "from 4 to 71.48")),
    (mf.PowerLaw(1.35, (0.02, 0.4)), HIGH, {}, ("1.35", "1.129")),
    (mf.PowerLaw(0.5, (0.1, 0.4)), HIGH, {}, ("0.5", "0.6667")),
    (mf.PowerLaw(0.38, (0.1, 0.4)), HIGH, under(mf.Elastic(mf.Power(4))), ("0.38", "0.4 ")),
    (mf.PowerLaw(1.2, (0.1, 0.4)), HIGH, under(mf.Elastic(Cone())), ("1.2", "at least 1 and at most 1")),
    (mf.PowerLaw(0.62, (0.1, 0.4)), HIGH, {"tools": [0.2, 0.8]}, ("0.62", "0.6283")),
    (mf.PowerLaw(0.1, (0.1, 0.4)), HIGH, {"tools": RANGE}, ("0.1", "0.1647")),
    (mf.PowerLaw(1.35, (0.02, 0.4)), HIGH, {"model": mf.Interacting()}, ("1.35", "margin")),
    (mf.SampledLaw([0.1, 0.2], [0.1, 1.0]), HIGH, {}, ("sample 1", "single asperity")),
    (mf.SampledLaw([0.1, 0.2, 0.3], [0.8, 2.0, 2.2]), HIGH, {}, ("sample 3", "F/P")),
    (mf.SampledLaw([0.1, 0.1001], [0.4, 1.2]), HIGH, {}, ("sample 2", "0.412481")),
    (mf.SampledLaw([0.02, 0.1], [0.15, 0.6]), HIGH, under(mf.Elastic(mf.Power(4))), ("sample 1", "0.224451")),
    (mf.SampledLaw.from_forces([0.2, 0.3], [50.0, 60.0], *PAIR), LOW, {}, ("0.2 N (0.147", "50 N")),
]
# The same, where no nearest target is known.
ALONE = [
    (after(1.68, 4.12), mf.Limits(0.15), {}, ("max_height", "0.0126")),
    (after(1.68, 4.12), mf.Limits(0.163), {}, ("point 3", "offset")),
    (after(1.68, 4.12), mf.Limits(0.27, min_height=0.15), {}, ("min_height", "0.15")),
    (mf.OperatingPoints([0.05, 0.1, 0.2], [0.8, 1.0, 2.5]), HIGH, {"tools": TOOLS}, ("tools",)),
    (mf.LinearLaw(1e200), LOW, {}, ("slope 1e+200", "double precision")),
    (mf.LinearLaw(6.87), LOW, under(mf.Elastic(Cone(0.3))), ("slope 6.87", "6.66667")),
    (mf.BilinearLaw((120.7, 160.9), 4.97e-5), LOW, {}, ("crossover", "double precision")),
    (mf.BilinearLaw((7.15, 9.0), 0.001), LOW, {"template": ONE}, ("1 of 1", "asperities")),
    (mf.LinearLaw(0.5, (0.01, 0.2)), TALL, {}, ("slope 0.5", "single asperity")),
    (mf.LinearLaw(7.0, (0.1, 90.0)), TALL, {}, ("90 mm^2 (122.4 N)",)),
    (mf.BilinearLaw((9.0, 30.0), 0.0572, (0.05, 0.7)), TALL, {}, ("slope 30", "0.0572")),
    (mf.PowerLaw(0.9, (0.1, 0.9)), mf.Limits(0.3, pinned=FEW), {}, ("0.9 mm", "2 summits")),
    (mf.PowerLaw(1.0, (0.1, 0.4), 100.0), HIGH, {}, ("prefactor = 100", "64 equal")),
    (mf.PowerLaw(1.2, (0.1, 0.4), 0.01), HIGH, {}, ("prefactor = 0.01",)),
    (mf.Band([0.05, 0.1], [5.0, 9.0], [6.0, 10.0]), HIGH, {}, ("end of the band",)),
    (mf.Band([0.05, 0.1, 0.2], [0.45, 0.3, 0.4], [0.5, 0.35, 0.5]), HIGH, {}, ("band",)),
    (mf.MultilinearLaw([1.0], [], (0.1, 0.4)), HIGH, {}, ("branch 1 of slope 1",)),
    (mf.MultilinearLaw([80.0], [], (0.1, 0.4)), HIGH, {}, ("branch 1 of slope 80",)),
]


@pytest.mark.parametrize("first", range(6))
def test_the_refused_and_the_nearest_target(first):
    rows = [(*row, True) for row in BOUNDS] + [(*row, False) for row in ALONE]
    for target, limits, rest, words, offered in rows[first::6]:
        options = {"template": LATTICE, "limits": limits, **rest}
        with pytest.raises(mf.Infeasible) as caught:
            mf.design(target, **options)
        nearest = caught.value.nearest
        assert [word for word in words if word not in str(caught.value)] == []
        assert (nearest is not None) == offered
        # the exponents of powers are those of a bound, which no surface attains
        if offered and not isinstance(target, mf.PowerLaw):
            near = mf.design(nearest, **options)
            assert near.misfit <= 0.01 or near.density


def test_one_asperity_has_no_line():
    with pytest.raises(mf.Infeasible, match="with 1 "):
        achievable_load_range(mf.LinearLaw(7.0), ONE, TALL)
