"""Given heights and empty sites with each option of a design."""

import numpy as np
import pytest

import metafem as mf
from tests.core.inversion.test_pinned import (
    EMPTY,
    TARGETS,
    TEMPLATE,
    TOP,
    assert_kept,
    designed,
    heights,
    made_law,
)

STEPS = mf.Limits(0.12, offset=0.08, height_step=0.006)
PINNED = {7: 0.19, 3: None, 20: 0.15, 35: 0.17}
LAYER = mf.Interacting(substrate=mf.BondedLayer())
OPTIONS = {
    "half-space": {"model": mf.Interacting()},
    "layer": {"model": LAYER},
    "radii": {"tools": [0.3, 0.526]},
    "power cap": {"model": mf.Independent(contact=mf.Elastic(mf.Power(4.0)))},
}


def near(result):
    """Return an empty site, and heights that differ by 3 um from some of the designed ones."""
    some = sorted(heights(result).items(), key=lambda pair: pair[1])[1:-1:4]
    return {**{site: float(np.clip(height - 0.003, 0.08, TOP)) for site, height in some}, 3: None}


@pytest.mark.parametrize(
    ("name", "model", "most"),
    [("points", mf.Interacting(), 1e-9), ("power", LAYER, 0.01), ("linear", mf.Automatic(), 0.08)],
)
def test_targets_are_met_under_every_model(name, model, most):
    pinned = near(designed(TARGETS[name], {3: None}))
    result = designed(TARGETS[name], pinned, model)
    assert_kept(result, pinned)
    assert result.misfit <= most
    assert result.law.model == model


@pytest.mark.parametrize(("name", "model"), [("linear", None), ("sampled", LAYER)])
def test_the_other_heights_are_on_steps(name, model):
    result = designed(TARGETS[name], PINNED, model, limits=STEPS)
    assert_kept(result, PINNED)
    others = [height for site, height in heights(result).items() if site not in PINNED]
    assert np.isin(np.round(others, 9), STEPS.levels.round(9)).all()
    if name == "sampled":
        assert result.parameters["step_counts"].sum() == len(others)


@pytest.mark.parametrize("name", OPTIONS)
def test_all_of_a_design_works_with_given_heights_and_empty_sites(name):
    made, target = made_law(OPTIONS[name].get("model"))
    pinned = {**dict(list(enumerate(made.height.tolist()))[::6]), 3: None}
    result = designed(target, pinned, **OPTIONS[name])
    assert_kept(result, pinned)
    assert result.misfit < 0.02
    if name != "power cap":
        result = designed(TARGETS["power"], EMPTY, **OPTIONS[name])
        assert result.misfit < 0.01
        assert not set(EMPTY) & set(result.sites.tolist())


def test_the_files_of_a_part_leave_the_sites_out(tmp_path):
    result = designed(TARGETS["power"], PINNED)
    mf.save(result, tmp_path / "result")
    assert mf.load(tmp_path / "result") == result
    lines = (tmp_path / "result" / "mould.csv").read_text().splitlines()
    rows = [line for line in lines if not line.startswith("#")][1:]
    assert {int(row.split(",")[2]) for row in rows} == set((result.sites + 1).tolist())
    assert result.template is TEMPLATE
