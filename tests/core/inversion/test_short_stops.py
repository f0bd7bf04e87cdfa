"""Designs that users met: base plane, blocks, hints of refusals, and scenes where searches ended early."""

import re

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus

MATERIAL = mf.Material(1.36)
SOFT = mf.Surface.square_lattice(
    0.085, (10, 10), 1.0, radius=1.25, material=mf.Material(2.5), friction=mf.Friction(0.35, 0.87),
    block=mf.Block(15.0, 15.0, 4.0),
)  # fmt: skip
LAYER = mf.Interacting(substrate=mf.BondedLayer())
LINE = mf.LinearLaw.from_friction_coefficient(1.6, SOFT.material, SOFT.friction, load_range_N=(0.1, 1.0))


def lattice(side, pitch=1.5, **rest):
    return mf.Surface.square_lattice(0.1, (side, side), pitch, radius=0.526, material=MATERIAL, **rest)


def touches(found):
    """Whether the plane would reach the base within the loads of the target."""
    approach = found.law.model.curve(found.surface, LINE.curve().load).approach
    return (approach > found.surface.height.max()).any()


def test_a_base_that_touches_within_the_range_is_a_miss_and_avoided():
    limits = mf.Limits(0.085)
    flat = mf.design(LINE, SOFT, LAYER, limits, 2, tools=[2.06])
    assert touches(flat)
    assert flat.status is DesignStatus.MISSED
    found = mf.design(LINE, SOFT, LAYER, limits, 2, tools=mf.RadiusRange(0.2, 4.0))
    assert not touches(found)
    assert found.misfit <= 0.01
    assert found.status is not DesignStatus.MISSED


def test_the_verdict_begins_with_the_status_and_names_the_layer_that_misses():
    found = mf.design(LINE, SOFT, mf.Independent(), mf.Limits(0.3))
    area = LAYER.curve(found.surface, LINE.curve().load).area
    off = np.abs(LINE.curve().difference(area)).max()
    assert found.status is not DesignStatus.MISSED
    assert off > 0.01
    word, size = found.status.name.lower(), f"{100 * off:.2g} %"
    start = f"{word} under the model independent, but {size} off on the bonded layer at "
    assert re.fullmatch(re.escape(start) + r"0\.\d{3} N \(0\.\d{3} mm\^2\)", found.verdict)


def test_no_cap_of_a_part_is_without_height(tmp_path):
    part = mf.Surface.square_lattice(0.15, radius=0.3, material=MATERIAL, block=mf.Block(12.0, 12.0, 7.2))
    load = np.linspace(0.05, 0.9, 20)
    try:
        found = mf.design(mf.SampledLaw(load, 0.3 * load**0.8), part, limits=mf.Limits(0.15))
    except mf.Infeasible as reason:
        found = mf.design(reason.nearest, part, limits=mf.Limits(0.15))
    assert found.surface.height.min() > 0.0
    mf.save(found, tmp_path / "design")


def test_a_hint_that_is_followed_meets_the_target():
    target, few = mf.LinearLaw(7.0, (0.03, 0.7)), lattice(8)
    with pytest.raises(mf.Infeasible, match="sites in all") as caught:
        mf.design(target, few, limits=mf.Limits(0.27))
    count = int(re.search(r"use (\d+) sites in all", str(caught.value)).group(1))
    more = mf.Surface.square_lattice(0.1, (1, count), radius=0.526, material=MATERIAL)
    assert mf.design(target, more, limits=mf.Limits(0.27)).misfit <= 0.01


@pytest.mark.parametrize("seed", [67, 3])
def test_uneven_loads_of_a_surface_are_met(seed):
    rng = np.random.default_rng(seed)
    height = 0.06 + 0.1 * np.where(np.arange(36) == 0, 1.0, 0.5 * rng.random(36))
    surface = lattice(6).replaced(height=height)
    last = mf.friction_law(surface, separation=[height.max() - 0.1]).rescaled_load[0]
    load = last * np.append(0.1 * (1.0 + 0.05 * np.arange(5)), [0.96, 0.98, 1.0])
    target = mf.SampledLaw(load, mf.Independent().curve(surface, load).area)
    assert mf.design(target, lattice(6), limits=mf.Limits(0.1, offset=0.06)).misfit <= 0.01


@pytest.mark.parametrize("seed", range(4))
def test_two_samples_on_nine_sites_are_met_with_every_seed(seed):
    target = mf.SampledLaw([0.00127, 0.0639], [0.0339, 0.4746])
    found = mf.design(target, lattice(3), limits=mf.Limits(0.15, offset=0.06), rng=seed)
    assert found.misfit <= 0.01


def test_the_number_of_asperities_on_steps_may_change():
    """Two at the top and five a level below have a misfit of 0.73 %."""
    limits = mf.Limits(0.06, offset=0.06, height_step=0.005)
    assert mf.design(mf.OperatingPoints([0.000864], [0.02278]), lattice(4), limits=limits).misfit <= 0.0074


def test_one_asperity_on_the_layer_meets_its_own_law():
    one = mf.Surface.square_lattice(
        0.1, (1, 1), radius=0.526, material=MATERIAL, block=mf.Block(100.0, 100.0, 7.2)
    )
    load = np.array([0.01])
    target = mf.OperatingPoints(load, LAYER.curve(one, load).area)
    assert mf.design(target, one, LAYER).misfit <= 0.01
