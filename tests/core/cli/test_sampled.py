"""`metafem design` of a measured law: a noisy table is designed, or refused with the nearest law."""

from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.files import demo_text
from validation.scenes.random_laws import random_law

pytestmark = pytest.mark.usefixtures("plain_reports")

REST = demo_text("linear").split("[material]")[1].replace('height_step = "6 um"', "")
SPEC = f'[target]\nkind = "sampled"\nfile = "measured.csv"\n[material]{REST}'


def written(noise, stated, seed=1):
    """Write the specification, and the table of a law with noise and, where `stated`, with error bars."""
    law, rng = random_law(seed, 23), np.random.default_rng(seed)
    load = 1.36 * law.rescaled_load
    force = 0.358 * 0.85 * law.rescaled_friction * (1.0 + rng.normal(0.0, noise, 23))
    titles = ["load_mN", "friction_force_mN"] + ["friction_force_sd_mN"] * stated
    columns = [1e3 * load, 1e3 * force] + [1e3 * noise * force] * stated
    rows = [",".join(map(repr, row)) for row in np.transpose(columns).tolist()]
    Path("measured.csv").write_text("\n".join([",".join(titles), *rows]))
    # flat and free enough for the random laws
    limits = 'max_height = "300 um"\noffset = "50 um"\n[layout]'
    head, _, tail = SPEC.partition("[limits]")
    Path("spec.toml").write_text(f"{head}[limits]\n{limits}{tail.partition('[layout]')[2]}")


@pytest.mark.slow
def test_a_measured_table_with_error_bars_is_designed_in_one_step(run):
    written(0.03, True)
    data = run("design", "spec.toml", "-o", "part", "--json").data
    assert data["status"] == "within_errors"
    assert 0.01 < data["misfit"] < 0.04
    assert any("no surface meets all samples" in note["text"] for note in data["notes"])
    assert Path("part/measured.csv").read_bytes() == Path("measured.csv").read_bytes()
    assert mf.load("part").target.relative_error == pytest.approx(0.03)
    assert run("compare", "part", "measured.csv").told


@pytest.mark.slow
def test_a_refusal_writes_the_nearest_law_which_is_met(run):
    written(0.06, False)
    error = run("design", "spec.toml", "-o", "part", "--json").missed["error"]
    assert error["type"] == "Infeasible"
    assert 'sampled target with file = "part-nearest.csv"' in error["message"]
    assert not Path("part").exists()
    table = np.genfromtxt("part-nearest.csv", delimiter=",", skip_header=2)
    assert (np.diff(table, axis=0) > 0.0).all()
    # a second refusal replaces its own table, and no other
    assert run("design", "spec.toml", "-o", "part").exit_code == 1
    Path("part-nearest.csv").rename("nearest.csv")
    Path("part-nearest.csv").write_text("mine")
    assert "the nearest law is not written" in run("design", "spec.toml", "-o", "part").stderr
    assert Path("part-nearest.csv").read_text() == "mine"
    Path("spec.toml").write_text(Path("spec.toml").read_text().replace("measured.csv", "nearest.csv"))
    assert run("design", "spec.toml", "-o", "part", "--json").data["misfit"] < 1e-3
