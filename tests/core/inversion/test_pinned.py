"""Heights for a target law among which some are given, and sites that stay empty."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus

TEMPLATE = mf.Surface.square_lattice(
    0.12, (6, 6), radius=0.526, material=mf.Material(1.36), block=mf.Block(12.0, 12.0, 7.2)
)
LIMITS, TOP, EMPTY = mf.Limits(0.12, offset=0.08), 0.2, dict.fromkeys((0, 7, 35))
TARGETS = {
    "points": mf.OperatingPoints([0.03, 0.1], [0.25, 0.8]),
    "linear": mf.LinearLaw(5.5),
    "sampled": mf.SampledLaw([0.05, 0.1, 0.2], [0.35, 0.62, 1.15]),
    "power": mf.PowerLaw(0.9, (0.05, 0.2), 4.9),
}


def designed(target, pinned=None, model=None, template=TEMPLATE, limits=LIMITS, **rest):
    return mf.design(target, template, model, replace(limits, pinned=pinned or {}), **rest)


def heights(result):
    return dict(zip(result.sites.tolist(), result.surface.height.tolist(), strict=True))


def assert_kept(result, pinned):
    found = heights(result)
    assert {site: found.get(site) for site in pinned} == pinned
    assert dict(result.pinned) == dict(sorted(pinned.items()))
    assert result.surface.height.min() >= LIMITS.foot
    assert result.surface.height.max() <= TOP


def made_law(model=None):
    """Return a surface and the law that it has."""
    made = TEMPLATE.replaced(height=0.2 - 0.1 * np.random.default_rng(3).random(36) ** 1.5)
    law = mf.friction_law(made, model, load=1.36 * np.linspace(0.01, 0.2, 40))
    return made, mf.SampledLaw(law.rescaled_load, law.rescaled_friction)


def test_given_heights_of_a_design_meet_its_target_again():
    for name, most in (("points", 1e-9), ("linear", 0.1), ("power", 0.01)):
        pinned = dict(list(heights(designed(TARGETS[name])).items())[::5])
        after = designed(TARGETS[name], pinned)
        assert_kept(after, pinned)
        assert after.misfit <= most
        assert not any("are given" in note.text for note in after.notes)


def test_the_other_height_of_two_follows_the_given_one():
    """The law of two asperities determines the difference of their heights."""
    for given in [0.17, TOP]:
        pair = TEMPLATE.only(slice(2), height=[0.2, 0.18])
        law = mf.friction_law(pair, load=1.36 * np.linspace(0.002, 0.05, 30))
        result = designed(mf.SampledLaw(law.rescaled_load, law.rescaled_friction), {1: given}, template=pair)
        assert result.misfit < 1e-3
        assert result.surface.height[1] == given
        assert abs(result.surface.height[0] - given) == pytest.approx(0.02, rel=1e-2)


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(substrate=mf.BondedLayer())], ids=repr)
def test_heights_of_a_surface_are_completed_for_its_law(model):
    """The target is the law of a surface, some of whose heights are given: the others reach it."""
    made, target = made_law(model)
    pinned = dict(list(enumerate(made.height.tolist()))[::3])
    result = designed(target, pinned, model)
    assert_kept(result, pinned)
    assert result.misfit < 0.002


def test_a_height_below_the_contacts_changes_nothing_where_sites_are_left():
    target = mf.SampledLaw([0.005, 0.01, 0.02], [0.05, 0.1, 0.2])
    after = designed(target, {4: 0.09})
    assert_kept(after, {4: 0.09})
    assert after.misfit < 1e-3


def test_the_others_are_adjusted_no_worse_than_left_alone():
    """The misfit is at most that of the designed heights among which the given ones are put."""
    rng, target = np.random.default_rng(5), TARGETS["power"].curve()
    plain = heights(designed(TARGETS["power"]))
    for _ in range(3):
        sites = rng.choice(36, 4, replace=False).tolist()
        pinned = dict(zip(sites, rng.uniform(0.1, TOP, 4).tolist(), strict=True))
        put = {**plain, **pinned}
        alone = TEMPLATE.only(list(put), height=list(put.values()))
        area = mf.Independent().curve(alone, target.load).area
        assert designed(TARGETS["power"], pinned).misfit <= max(target.misfit(area), 1e-3)


def test_too_many_given_heights_miss_the_target_and_say_so():
    pinned = dict.fromkeys(range(34), TOP)
    result = designed(TARGETS["power"], pinned)
    assert_kept(result, pinned)
    assert result.status is DesignStatus.MISSED
    every = dict(enumerate(np.linspace(0.1, TOP, 36).tolist()))
    assert heights(designed(TARGETS["power"], every)) == every


def test_the_heights_are_those_of_a_template_without_the_empty_sites():
    for name in ["points", "linear"]:
        result = designed(TARGETS[name], EMPTY)
        assert not set(EMPTY) & set(result.sites.tolist())
        assert dict(result.pinned) == EMPTY
        assert result.template is TEMPLATE
        fewer = TEMPLATE.only(np.setdiff1d(np.arange(36), list(EMPTY)))
        alone = mf.design(TARGETS[name], fewer, limits=LIMITS)
        # the law of independent asperities does not depend on the sites
        np.testing.assert_array_equal(np.sort(result.surface.height), np.sort(alone.surface.height))
        assert result.misfit == pytest.approx(alone.misfit, rel=1e-9, abs=1e-12)
