"""Samples with errors: which are designed, which are refused, and what is said of them."""

import numpy as np
import pytest

import metafem as mf
from validation.scenes.random_laws import LATTICE, noisy_law, random_law

LIMITS = mf.Limits(0.6)


def test_the_nearest_law_of_a_refusal_is_that_of_a_surface():
    """It is met to the goal of the search, which is far below the 1 % that counts as reached."""
    for seed in range(4):
        law, rng = random_law(seed, 20), np.random.default_rng(seed)
        friction = law.rescaled_friction * (1.0 + rng.normal(0.0, 0.05, 20))
        with pytest.raises(mf.Infeasible) as caught:
            mf.design(mf.SampledLaw(law.rescaled_load, friction), LATTICE, limits=LIMITS)
        assert mf.design(caught.value.nearest, LATTICE, limits=LIMITS).misfit < 1e-3


@pytest.mark.slow
def test_no_noisy_law_is_refused_whose_best_surface_is_within_a_percent_of_the_noise():
    for seed in range(20):
        target, true = noisy_law(seed)
        design = mf.design(target, LATTICE, limits=LIMITS)
        law = target.curve()
        assert design.misfit <= min(law.misfit(true), design.largest_misfit)


@pytest.mark.parametrize("seed", range(6))
def test_laws_of_two_levels_are_found(seed):
    rng = np.random.default_rng(seed)
    number, low = int(rng.integers(1, 15)), rng.uniform(0.12, 0.19)
    height = np.where(np.arange(16) < number, 0.2, low)
    surface = mf.Surface.square_lattice(height, (4, 4), 1.5, radius=0.526, material=mf.Material(1.36))
    load = np.linspace(0.003, 0.15, 14)
    target = mf.SampledLaw(load, mf.Independent().curve(surface, load).area)
    found = mf.design(target, surface.replaced(height=np.full(16, 0.2)), limits=mf.Limits(0.2))
    assert found.misfit < 1e-3
