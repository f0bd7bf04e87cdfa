"""Shares of the misfit against the dense formula of its quadratic form, and their sentences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import Priors, explain
from metafem.calibration.diagnosis.causes import Causes
from metafem.calibration.diagnosis.sentences import models, ranking
from metafem.calibration.diagnosis.shares import unresolved
from tests.calibration.diagnosis.scenes import COMMON, ERRORS, LOADS, design, measured

PART = design((3, 3))


def test_shares_add_up_and_the_misfit_is_that_of_the_prior_prediction():
    law = measured(PART.tilted(0.001, 0.0), rng=np.random.default_rng(0))
    found = explain(law, PART, Priors(), model=mf.Independent())
    assert sum(found.shares.values()) == pytest.approx(1.0)
    assert list(found.shares.values()) == sorted(found.shares.values(), reverse=True)
    # the misfit with all errors, at its minimum, is that of the values and of the errors over their priors
    squares = sum(float(np.nansum(values**2)) for values in found.residual.values())
    for cause in found.causes:
        squares += (cause.mean / cause.prior_sd) ** 2
    for errors in found.single.values():
        squares += float((errors.mean**2).sum()) / errors.prior_sd**2
    assert found.misfit == pytest.approx(squares, rel=0.02)
    assert found.misfit < found.misfit_design


def test_the_misfit_without_a_cause_is_that_of_an_explanation_without_it():
    law = measured(PART, stiffer=1.05, rng=np.random.default_rng(1))
    found = explain(law, PART, COMMON, model=mf.Independent())
    other = explain(law, PART, replace(COMMON, composite_modulus_sd=0.0), model=mf.Independent())
    assert found.misfit_without["composite_modulus"] == pytest.approx(other.misfit, rel=0.05)
    assert all(value >= found.misfit for value in found.misfit_without.values())


def test_a_negative_share_is_stated_so_that_the_named_ones_add_to_one():
    assert ranking({"tilt": 0.7, "height": 0.3}) == [
        "It is explained by tilt (70 %) and single heights (30 %)."
    ]
    first, second = ranking({"radius": 0.95, "composite_modulus": 0.25, "friction": -0.2})
    assert first == "It is explained by radii (95 %) and E* (25 %)."
    assert second.startswith("All shares add to 100 %: negative is that of σB (-20 %)")


@pytest.mark.parametrize(("ratio", "odds"), [(0.4, "1.5"), (9.0, "8,100"), (6894.0, "more than 10^6")])
def test_odds_are_written_out_up_to_a_million(ratio, odds):
    (sentence,) = models({"JKR": 0.0, "Hertz": -ratio})
    assert f"({odds} to 1)" in sentence


def found(gradient: np.ndarray):
    """Return what data with these derivatives by the five errors leave unresolved."""
    causes = Causes.of(design((2, 2)), LOADS, ERRORS.of_load(LOADS), COMMON, True)
    precision = np.eye(causes.size)
    precision[:5, :5] += gradient.T @ gradient
    return unresolved(causes, np.linalg.inv(precision))


def test_a_sum_of_two_errors_leaves_their_difference():
    gradient = np.diag([100.0, 100.0, 100.0, 0.0, 0.0])
    gradient[3, 3:] = 100.0
    (one,) = found(gradient)
    assert set(one.change) == {"composite_modulus", "friction"}
    assert one.change["composite_modulus"] * one.change["friction"] < 0.0
    assert one.variance_left > 0.999


def test_what_is_not_measured_is_named_alone_and_what_is_measured_is_not():
    names = [set(one.change) for one in found(np.diag([0.0, 100.0, 100.0, 100.0, 0.0]))]
    assert names == [{"angle_x"}, {"friction"}]
    assert found(100.0 * np.eye(5)) == ()
