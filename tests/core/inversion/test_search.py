"""Least squares within limits, laws with open parameters, and the first guesses of heights."""

import math

import numpy as np
import pytest
from metafem.inversion.search.initial_guess import initial_heights
from metafem.inversion.search.levenberg_marquardt import descend, search
from metafem.inversion.search.spaces import Bounded, Heights
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.strategies.level import Level, Step

import metafem as mf
from metafem.contact.law import contacts

START, MATERIAL = np.array([0.3, 0.2, 0.1]), mf.Material(1.36)
LIMITED = Bounded(0.0, 1.0, np.array([1]), np.array([0.5]))
LOAD = np.geomspace(0.1, 0.4, 30)


def bent(height):
    """Return a residual of two rows with its Jacobian; its roots have differences of 0.1 and 0.25."""
    first, second = height[0] - height[1] - 0.1, height[1] - height[2] - 0.25
    gradient = np.array([[1.0, -1.0, 0.0], [0.0, 1.0 + 2.0 * second, -1.0 - 2.0 * second]])
    return np.array([first, second + second**2]), lambda: gradient


def test_a_descent_converges_to_rounding_with_few_jacobians():
    calls = []

    def counted(height):
        calls.append("residual")
        residual, jacobian = bent(height)
        return residual, lambda: calls.append("jacobian") or jacobian()

    found = descend(counted, START, Heights(1.0), 1e-14, to_rounding=True)
    assert found.misfit <= 1e-14
    np.testing.assert_allclose(-np.diff(found.unknowns), [0.1, 0.25], rtol=1e-12)
    assert calls[-1] == "residual"
    assert calls.count("jacobian") < calls.count("residual")


def test_heights_stay_within_the_span():
    found = descend(bent, START, Heights(0.3), 1e-14, to_rounding=True)
    assert np.ptp(found.unknowns) == pytest.approx(0.3, rel=1e-12)
    assert 0.0 < found.misfit < 0.05


def test_a_search_meets_its_goal():
    found = search(bent, [START, np.array([0.5, 0.1, 0.0])], Heights(1.0), 1e-6, 5, np.random.default_rng(0))
    assert np.sqrt((bent(found.unknowns)[0] ** 2).mean()) <= 1e-6


def test_heights_at_absolute_limits_stay_where_a_step_would_pass_them():
    np.testing.assert_array_equal(LIMITED.project(np.array([-1.0, 3.0, 2.0])), [0.0, 0.5, 1.0])
    residual = LIMITED.held(lambda height: (np.array([1.0]), lambda: np.array([[2.0, 3.0, 4.0]])))
    # down the gradient all heights sink
    np.testing.assert_array_equal(residual(np.array([0.0, 0.5, 1.0]))[1](), [[0.0, 0.0, 4.0]])
    np.testing.assert_array_equal(residual(np.array([0.1, 0.5, 1.0]))[1](), [[2.0, 0.0, 4.0]])


def test_a_descent_ends_at_the_least_squares_within_the_limits():
    """Of the squares of h - (2, 0.2, 0.7) the least within the limits is at (1, 0.5, 0.7)."""
    wanted, start = np.array([2.0, 0.2, 0.7]), np.array([0.2, 0.5, 0.1])
    found = descend(lambda height: (height - wanted, lambda: np.eye(3)), start, LIMITED, 0.0, True)
    np.testing.assert_allclose(found.unknowns, [1.0, 0.5, 0.7], atol=1e-6)


def test_random_changes_add_and_remove_asperities_but_keep_the_given_ones():
    rng, start = np.random.default_rng(0), np.array([0.3, 0.5, 0.8, *[LIMITED.absent] * 5])
    numbers = set()
    for _ in range(50):
        height = LIMITED.changed(start, rng, (0.3, 1.0, 3.0))
        exists = LIMITED.exists(height)
        assert height[1] == 0.5
        assert ((height[exists] >= 0.0) & (height[exists] <= 1.0)).all()
        assert (height[~exists] == LIMITED.absent).all()
        numbers.add(int(exists.sum()))
    assert min(numbers) < 3 < max(numbers)


def test_many_laws_are_those_of_each():
    line = TargetLaw(LOAD, np.zeros(30), np.column_stack([LOAD, np.ones(30)]), np.ones(30))
    area = 9.0 * LOAD**0.85 * (1.0 + 0.05 * np.random.default_rng(0).standard_normal((20, 30)))
    # far from a line: the nearest one is not positive
    area[0] = 1e-3 + 1e3 * LOAD**8
    for law in (TargetLaw.fixed(LOAD, 7.0 * LOAD), mf.PowerLaw(0.9, (0.1, 0.4)).curve(), line):
        np.testing.assert_allclose(law.laws(area), [law.law(row) for row in area], rtol=1e-12)


def test_a_thinned_law_keeps_its_ends_and_weights():
    law = TargetLaw.fixed(LOAD, 7.0 * LOAD, np.arange(1.0, 31.0))
    thin = law.thinned(7)
    assert (len(thin.load), thin.load[0], thin.load[-1]) == (7, 0.1, 0.4)
    assert thin.weight.mean() == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_array_equal(thin.base, 7.0 * thin.load)
    assert law.thinned(30) is law


def test_no_asperity_enters_where_the_earlier_ones_have_load_and_area():
    """The law of one asperity: between two samples the first has both, up to rounding."""
    for law in (mf.Elastic(mf.Power(3.7)), mf.KogutEtsion(14.0).for_material(MATERIAL)):
        for depth in np.random.default_rng(0).uniform(1e-3, 0.02, 20):
            one = contacts(law, depth * np.geomspace(0.01, 1.0, 6), np.array(0.526))
            height, radius, _ = initial_heights(law, one.load, one.area, np.full(6, 0.526), 4)
            assert len(height) == len(radius) >= 1
            assert ((-depth <= height) & (height <= 0.0)).all()


def test_no_number_of_asperities_meets_a_point_whose_load_the_earlier_ones_exceed():
    earlier = Level(height=0.1, number=10, radius=0.526, other=0.526, depth=0.0, adjustment=0.0)
    # ten contacts of Hertz at 0.05 mm carry 0.108 mm^2 with 0.83 mm^2 of area
    needed = [Step(mf.Hertz(), (earlier,), 0.05, load, 1.0).needed(0.526) for load in (0.05, 0.2)]
    assert needed[0] == math.inf
    assert math.isfinite(needed[1])
