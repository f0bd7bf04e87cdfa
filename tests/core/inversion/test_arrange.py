"""Arrangements: forecasts that price every exchange, and laws that the sites make better."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.placement.exchange import sites_for

LOAD = np.array([0.05, 0.15, 0.3])
LAYER = mf.Interacting(substrate=mf.BondedLayer())
TILT = mf.InsensitiveToTilt(LOAD)
BOTH = mf.WeightedObjectives([mf.FollowLaw(LOAD), TILT], [3.0, 1.0])


@pytest.fixture
def uneven():
    rng = np.random.default_rng(4)
    height, radius = 0.1 + rng.exponential(0.02, 36), rng.uniform(0.4, 0.6, 36)
    part = {"material": mf.Material(1.36), "block": mf.Block(12.0, 12.0, 7.2)}
    return mf.Surface.square_lattice(height, (6, 6), radius=radius, **part)


def test_forecast_prices_every_exchange_as_if_it_were_made(uneven):
    more = np.vstack([uneven.position, [[9.0, 0.0], [0.0, 9.0]]])
    sites, model = sites_for(uneven, mf.Interacting(), more)
    forecast = BOTH.forecast(uneven, model, sites)
    changes = forecast.changes(np.arange(38))
    for i, j in [(0, 1), (3, 30), (35, 7), (12, 12), (4, 36), (36, 37)]:
        after = forecast.swapped(i, j)
        np.testing.assert_allclose(changes[:, i, j], after.residual() - forecast.residual(), atol=1e-15)
        again = after.swapped(i, j)
        np.testing.assert_allclose(again.residual(), forecast.residual(), atol=1e-15)


def test_forecast_of_the_law_is_its_first_order_change(uneven):
    """A slight shift of a place is felt as the forecast says."""
    objective, model = mf.FollowLaw(LOAD), LAYER
    moved = uneven.position.copy()
    moved[7, 0] += 1e-5
    here, there = (sites_for(uneven.replaced(position=p), model, None)[0] for p in (uneven.position, moved))
    forecast = objective.forecast(uneven, model, here)
    foreseen = replace(forecast, influence=there.influence).residual() - forecast.residual()
    made = objective.residual(uneven.replaced(position=moved), model) - objective.residual(uneven, model)
    # the forecast holds the point loads of order 1 alone
    np.testing.assert_allclose(foreseen, made, rtol=0.02, atol=0.02 * np.abs(made).max())


def test_small_tilts_change_the_law_by_the_first_moments(uneven):
    angle = 1e-7
    model = mf.Interacting()
    found = model.sensitivity(uneven, LOAD)
    moments = found.gradient @ uneven.position / found.curve.area[:, None] * angle
    change = mf.InsensitiveToTilt(LOAD, angle).residual(uneven, model).reshape(6, 3) * np.sqrt(18)
    scale = np.abs(moments).max()
    np.testing.assert_allclose(change[0], moments[:, 0], atol=1e-3 * scale)
    np.testing.assert_allclose((change[1] + change[2]) / np.sqrt(3.0), moments[:, 1], atol=1e-3 * scale)


def test_arranged_laws_follow_the_independent_one(uneven):
    result = mf.arrange(uneven, mf.FollowLaw(LOAD), LAYER)
    assert result.after < 0.1 * result.before
    again = mf.FollowLaw(LOAD).residual(result.surface, LAYER)
    assert np.linalg.norm(again) == pytest.approx(result.after, rel=1e-12)


CORNERS = np.array([[9.0, 9.0], [-9.0, 9.0], [9.0, -9.0], [-9.0, -9.0]])


class Matrices:
    """The half-space as a substrate of no radial kind."""

    influence_matrix = staticmethod(mf.HalfSpace().influence_matrix)
    influence_derivatives = staticmethod(mf.HalfSpace().influence_derivatives)

    def for_surface(self, surface):
        return self


def test_a_substrate_without_a_formula_is_arranged_by_its_matrices(uneven):
    more, law = np.vstack([CORNERS, uneven.position]), mf.FollowLaw(LOAD)
    result = mf.arrange(uneven, law, mf.Interacting(substrate=Matrices()), position=more)
    assert result.after < 0.1 * result.before
    assert result.after == pytest.approx(np.linalg.norm(law.residual(result.surface, mf.Interacting())))


def test_places_that_stay_empty_are_told(uneven):
    more = np.vstack([CORNERS, uneven.position])
    result = mf.arrange(uneven, mf.FollowLaw(LOAD), position=more)
    assert result.after < result.before == mf.arrange(uneven, mf.FollowLaw(LOAD)).before
    np.testing.assert_array_equal(result.position, more)
    assert (result.order == -1).sum() == 4
    np.testing.assert_array_equal(np.sort(result.order[result.sites]), np.arange(36))
    np.testing.assert_array_equal(result.surface.position, more[result.sites])
    np.testing.assert_array_equal(result.surface.height, uneven.height[result.order[result.sites]])
    np.testing.assert_array_equal(result.surface.radius, uneven.radius[result.order[result.sites]])
