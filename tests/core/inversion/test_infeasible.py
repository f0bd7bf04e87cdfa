"""Targets that no surface reaches are refused with the bound, and with the nearest target that one does."""

import pytest

import metafem as mf
from metafem.inversion import achievable_load_range
from metafem.inversion.guesses import frictions
from metafem.inversion.problem import Problem
from metafem.inversion.wording import Wording

LATTICE = mf.Surface.square_lattice(0.3, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.4))
HIGH, TALL, LOW = mf.Limits(0.3), mf.Limits(0.27), mf.Limits(0.12, offset=0.05)
PAIR = LATTICE.material, LATTICE.friction
TOOLS = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4))]
ONE = LATTICE.only(slice(1))
FEW = dict.fromkeys(range(62))


def after(second, third):
    """Return three operating points with some frictions of the last two."""
    return mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, second, third])


def coefficients(*mu):
    wording = Wording.of(*PAIR)
    return mf.BilinearLaw(wording.given_slopes(mu, 2), 0.038, wording=wording)


def under(contact, template=LATTICE):
    return {"model": mf.Independent(contact=contact), "template": template}


# The target, its limits, other arguments, and words of the error: where the bound lies, or what it is.
BOUNDS = [
    (after(1.68, 9.0), TALL, {}, ("0.649", "64 equal")),
    (after(1.0, 4.0), TALL, {}, ("0.144",)),
    (after(1.68, 4.12), mf.Limits(0.15), {}, ("max_height", "0.0172")),
    (after(1.68, 4.12), mf.Limits(0.27, min_height=0.15), {}, ("min_height", "0.15")),
    (mf.OperatingPoints([0.0001], [1e-4]), TALL, {}, ("single asperity",)),
    (
        mf.OperatingPoints([0.05, 0.1, 0.2], [0.8, 1.0, 2.5]),
        HIGH,
        {"tools": TOOLS},
        ("no heights", "0.1 mm^2"),
    ),
    (mf.LinearLaw(3.0), LOW, {}, ("slope 3", "4.93303")),
    (mf.LinearLaw.from_friction_coefficient(0.9, *PAIR), LOW, {}, ("friction coefficient 0.9", "1.45")),
    (mf.LinearLaw(1.0), HIGH, {"tools": [0.2, 0.8]}, ("slope 1", "0.2 mm")),
    (mf.BilinearLaw((7.15, 12.0), 5.0), LOW, {}, ("crossover_load = 5", "0.4354")),
    (mf.BilinearLaw((7.15, 12.0), 0.4), LOW, {}, ("second slope", "7.78")),
    (coefficients(1.6, 90.0), LOW, {}, ("friction_coefficients[1] = 90", "0.05168 N")),
    (mf.SampledLaw([0.1, 0.2], [0.1, 1.0]), HIGH, {}, ("0.1 mm", "single asperity")),
    (mf.SampledLaw([0.1, 0.1001], [0.4, 1.2]), HIGH, {}, ("0.1001", "0.412481")),
    (mf.SampledLaw([0.02, 0.1], [0.15, 0.6]), HIGH, under(mf.Elastic(mf.Power(4))), ("0.02", "0.224451")),
    (mf.SampledLaw.from_forces([0.2, 0.3], [50.0, 60.0], *PAIR), LOW, {}, ("0.2 N (0.147", "50 N")),
    (mf.Band([0.05, 0.1], [5.0, 9.0], [6.0, 10.0]), HIGH, {}, ("64 equal",)),
    (mf.PowerLaw(0.5, (0.1, 0.4)), HIGH, {}, ("12 %",)),
    (mf.PowerLaw(0.62, (0.1, 0.4)), HIGH, {"tools": [0.2, 0.8]}, ("0.574 %",)),
    (mf.PowerLaw(1.0, (0.1, 0.4), 100.0), HIGH, {}, ("64 equal",)),
    (mf.MultilinearLaw([80.0], [], (0.1, 0.4)), HIGH, {}, ("free parameter",)),
    (mf.MultilinearLaw([1.0], [], (0.1, 0.4)), HIGH, {}, ("25.5 %",)),
]
# The same, where no nearest target is known, or none that is surely within reach.
ALONE = [
    (mf.PowerLaw(1.35, (0.02, 0.4)), HIGH, {"model": mf.Interacting()}, ("margin",)),
    (mf.LinearLaw(7.0, (0.1, 90.0)), TALL, {}, ("90 mm^2 (122.4 N)", "reached from")),
    (mf.LinearLaw(1e3), LOW, under(mf.Elastic(mf.Power(4))), ("load_range",)),
    (mf.LinearLaw(1e200), LOW, {}, ("slope 1e+200", "double precision")),
    (mf.BilinearLaw((120.7, 160.9), 4.97e-5), LOW, {}, ("crossover", "4.97e-05")),
    (mf.BilinearLaw((7.15, 9.0), 0.001), LOW, {"template": ONE}, ("one of 1 asp", "asperities")),
    (mf.PowerLaw(0.9, (0.1, 0.9)), mf.Limits(0.3, pinned=FEW), {}, ("0.9 mm", "2 summits")),
]


# a search with several tools, whose restarts do not agree
SLOW = pytest.param(5, marks=pytest.mark.slow)


@pytest.mark.parametrize("first", [*range(5), SLOW, *range(6, 30)])
def test_the_refused_and_the_nearest_target(first):
    rows = [(*row, True) for row in BOUNDS] + [(*row, False) for row in ALONE]
    for target, limits, rest, words, offered in rows[first::30]:
        options = {"template": LATTICE, "limits": limits, **rest}
        with pytest.raises(mf.Infeasible) as caught:
            mf.design(target, **options)
        assert [word for word in words if word not in str(caught.value)] == []
        if offered:
            near = mf.design(caught.value.nearest, **options)
            assert near.misfit <= 0.03 or near.density


@pytest.mark.slow
def test_the_range_of_a_line_with_tools_of_two_shapes_is_found():
    low, high = achievable_load_range(mf.LinearLaw(7.0), LATTICE, HIGH, TOOLS, mf.Elastic())
    assert low < 0.1 < high


def test_one_asperity_has_no_line():
    with pytest.raises(mf.Infeasible, match="with 1 "):
        achievable_load_range(mf.LinearLaw(7.0), ONE, TALL)


def test_a_power_beyond_every_exponent_of_a_range_is_refused_with_what_was_found():
    """Nothing is proven of caps of several exponents."""
    few = LATTICE.only(slice(4))
    options = {"template": few, "limits": HIGH, "tools": mf.PowerRange(1.2, 6.0)}
    with pytest.raises(mf.Infeasible, match="found") as caught:
        mf.design(mf.PowerLaw(0.1, (0.01, 0.03)), **options)
    assert mf.design(caught.value.nearest, **options).misfit <= 0.01


def test_a_free_level_has_guesses_also_where_nothing_is_proven():
    """The law is steeper than any between the bounds, and of adhesive contacts none are known."""
    problem = Problem.checked(
        mf.PowerLaw(1.5, (0.001, 0.4)), LATTICE, mf.Independent(mf.JKR(9e-6)), HIGH, [0.2, 0.8]
    )
    (found,) = frictions(problem.law, problem.bounds)
    assert (found > 0.0).all()
