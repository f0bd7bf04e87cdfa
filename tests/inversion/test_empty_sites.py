"""Designs with sites that stay empty: those of a template with fewer sites."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

import metafem as mf

TEMPLATE = mf.Surface.square_lattice(
    0.12, (6, 6), radius=0.526, material=mf.Material(1.36), block=mf.Block(12.0, 12.0, 7.2)
)
LIMITS = mf.Limits(0.12, offset=0.08)
EMPTY = dict.fromkeys((0, 7, 35))
TARGETS = {
    "points": mf.OperatingPoints([0.03, 0.1], [0.25, 0.8]),
    "linear": mf.LinearLaw(5.5),
    "line": mf.LinearLaw(6.0, (0.05, 0.1)),
    "bilinear": mf.BilinearLaw((8.0, 6.5), 0.1),
    "sampled": mf.SampledLaw([0.05, 0.1, 0.2], [0.35, 0.62, 1.15]),
    "power": mf.PowerLaw(0.9, (0.05, 0.2)),
    "multilinear": mf.MultilinearLaw((6.5, 5.5), (0.1,), (0.05, 0.2)),
}


def designed(target, pinned=MappingProxyType({}), **rest):
    limits = replace(LIMITS, pinned=pinned)
    return mf.design(target, TEMPLATE, rest.pop("model", None), limits, **rest)


@pytest.mark.parametrize("name", TARGETS)
def test_without_pins_the_design_is_unchanged_to_the_bit(name):
    assert designed(TARGETS[name], pinned={}) == designed(TARGETS[name])


@pytest.mark.parametrize("name", ["points", "linear", "bilinear"])
def test_the_heights_are_those_of_a_template_without_the_empty_sites(name):
    result = designed(TARGETS[name], pinned=EMPTY)
    assert not set(EMPTY) & set(result.sites.tolist())
    assert dict(result.pinned) == EMPTY
    assert result.template is TEMPLATE
    left = np.setdiff1d(np.arange(36), list(EMPTY))
    fewer = mf.Surface(TEMPLATE.position[left], TEMPLATE.height[left], 0.526, TEMPLATE.material)
    alone = mf.design(TARGETS[name], fewer, limits=LIMITS)
    # the law of independent asperities does not depend on the sites
    np.testing.assert_array_equal(np.sort(result.surface.height), np.sort(alone.surface.height))
    assert result.misfit == pytest.approx(alone.misfit, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("name", ["line", "sampled", "power", "multilinear"])
def test_laws_of_any_shape_are_met_without_the_empty_sites(name):
    result = designed(TARGETS[name], pinned=EMPTY)
    assert not set(EMPTY) & set(result.sites.tolist())
    assert result.misfit < 0.01


@pytest.mark.parametrize(
    "rest",
    [
        {"layout": mf.Layout(tilt=0.001)},
        {"model": mf.Interacting()},
        {"model": mf.Interacting(substrate=mf.BondedLayer())},
        {"radii": [0.3, 0.526]},
        {"radii": [0.3, 0.526], "common_radius": True},
        {"robust": mf.Tolerances(height_sd=0.002, angle=0.001)},
    ],
    ids=["layout", "half-space", "layer", "radii", "common radius", "robust"],
)
def test_all_of_a_design_works_without_the_empty_sites(rest):
    result = designed(TARGETS["power"], pinned=EMPTY, **rest)
    assert result.misfit < 0.01
    assert not set(EMPTY) & set(result.sites.tolist())
    np.testing.assert_array_equal(result.surface.position, TEMPLATE.position[result.sites])


def test_heights_stay_on_their_steps():
    limits = mf.Limits(0.12, offset=0.08, height_step=0.006, pinned=EMPTY)
    result = mf.design(TARGETS["power"], TEMPLATE, limits=limits)
    assert np.isin(result.surface.height.round(9), limits.levels.round(9)).all()


def test_too_few_sites_are_refused_with_their_number():
    with pytest.raises(mf.Infeasible, match="with 2 summits of the largest height"):
        designed(mf.LinearLaw(6.0, (0.05, 0.2)), pinned=dict.fromkeys(range(34)))


def test_the_files_of_a_part_leave_the_sites_out(tmp_path):
    result = designed(TARGETS["power"], pinned=EMPTY)
    mf.save(result, tmp_path / "result")
    assert mf.load(tmp_path / "result") == result
    rows = (tmp_path / "result" / "mould.csv").read_text().splitlines()[1:]
    assert {int(row.split(",")[2]) for row in rows} == set(result.sites.tolist())
    assert (tmp_path / "result" / "block.stl").exists()
