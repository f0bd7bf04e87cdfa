"""Heights on the steps of a machine, for every kind of law."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.inversion.problem import Problem
from metafem.inversion.refinement import inverted
from metafem.inversion.steps import on_steps
from tests.models.scenes import said

STEP = 0.006
LIMITS = mf.Limits(0.27, offset=0.05, height_step=STEP)
TARGETS = {
    "points": mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]),
    "sampled": mf.SampledLaw([0.1, 0.2, 0.3, 0.4], [0.9, 1.6, 2.3, 3.0]),
    "power": mf.PowerLaw(1.2, (0.1, 0.4)),
    "multilinear": mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26)),
}


# three searches for slopes under interaction take two seconds
SLOW = pytest.param("multilinear", marks=pytest.mark.slow)


@pytest.mark.parametrize("name", [*(name for name in TARGETS if name != "multilinear"), SLOW])
def test_heights_stand_on_steps_and_the_loss_is_told(template, name):
    model = mf.Independent() if name in ("sampled", "power") else mf.Interacting(order=1)
    result = mf.design(TARGETS[name], template, model, LIMITS)
    steps = (result.surface.height - LIMITS.foot) / STEP - 0.5
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)
    assert result.misfit < 0.006
    assert result.status in (DesignStatus.REACHED, DesignStatus.REFINED)
    assert f"the misfit is {100 * result.misfit:.3g} %" in said(result)
    before = mf.design(TARGETS[name], template, model, mf.Limits(0.27, offset=0.05)).misfit
    assert result.parameters["step_loss"] == pytest.approx(result.misfit - before, abs=1e-3)
    used, counts = np.unique(result.surface.height, return_counts=True)
    np.testing.assert_array_equal(result.parameters["step_levels"], used)
    np.testing.assert_array_equal(result.parameters["step_counts"], counts)


def test_coarse_steps_miss_and_say_so(template):
    for step, levels in [(0.135, 2), (0.27, 1)]:
        limits = mf.Limits(0.27, height_step=step)
        result = mf.design(TARGETS["power"], template, limits=limits)
        assert len(limits.levels) == levels
        assert set(result.surface.height) <= set(limits.levels)
        assert result.status is DesignStatus.MISSED


def test_a_search_on_steps_stays_on_one_set_of_sites(template, monkeypatch):
    """The influence on the real block takes a minute for each set."""
    problem = Problem.checked(TARGETS["power"], template, limits=mf.Limits(0.27, height_step=0.02))
    rng = np.random.default_rng(0)
    candidate, seen, surface = inverted(problem, rng), set(), Problem.surface

    def recorded(self, at):
        seen.add(at.sites.tobytes())
        return surface(self, at)

    monkeypatch.setattr(Problem, "surface", recorded)
    on_steps(problem, candidate, rng)
    assert len(seen | {candidate.asperities.sites.tobytes()}) <= 2
