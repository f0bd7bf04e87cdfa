"""The stated error of order 3, and its comparison with tamaas."""

import re
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from validation.check import below, reported
from validation.cost import model_table
from validation.fidelity import order3_independent as against
from validation.readme import README
from validation.results import Evaluated
from validation.scenes.models import (
    AREA_ERROR,
    CAP_ERROR,
    CAP_LOAD_ERROR,
    FEW_ERROR,
    LAYER_ERROR,
    LOAD_ERROR,
)
from validation.sources import known_input
from validation.verdicts import Evidence, answer

GUIDE = Path(against.__file__).parents[1] / "guide" / "models.md"


def test_all_documents_state_one_error_of_order_3():
    stated, few, layer, load, cap, cap_load = (
        f"{100.0 * each:g} %"
        for each in (AREA_ERROR, FEW_ERROR, LAYER_ERROR, LOAD_ERROR, CAP_ERROR, CAP_LOAD_ERROR)
    )
    documented, guide = (
        re.sub(r"\s+", " ", text) for text in (mf.Interacting.__doc__, GUIDE.read_text("utf-8"))
    )
    assert f"{stated} in A0 at fixed load ({few} for up to nine contacts)" in documented
    assert f"{load} in the total load" in documented
    assert f"order 3 in A0 is at most {layer} up to a/t = 0.3" in documented
    assert f"Its error of A0 is at most {stated} ({few} for up to nine contacts)" in guide
    assert f"by at most {cap_load} in the load and {cap} in A0" in documented
    assert f"at most {cap} for nine spheres or power caps, up to power 4" in guide
    assert f"spheres and caps of power 3 or 4 to {cap};" in README.read_text("utf-8")
    assert (
        f"A0 to {stated} up to a/r = 0.32" in {row[0]: row[-1] for row in model_table.TABLE}["Interacting()"]
    )
    assert f"A0 to {stated} up to a/r = 0.32" in README.read_text("utf-8")


def verdict(*more):
    source = known_input("a test")
    rows = {
        "order3_against_resolved": (
            below("a lattice, order 3: error of A0", 7e-4, 1e-2, source),
            reported("3 x 3, approach 300 µm, order 1: error of A0 [%]", 0.5, ""),
            reported("3 x 3, approach 300 µm: largest a/r", 0.222, ""),
            reported("3 x 3, a/r = 0.319, paraboloid, order 1: error of A0 [%]", 1.5, ""),
            *(
                below(f"3 x 3, a/r = 0.319, {shape}, order 3: error of A0", error, 4e-3, source)
                for shape, error in (("sphere", 2.1e-3), ("power 3", 3.3e-3), ("power 4", 3.8e-3))
            ),
        ),
        "stability_map": (reported("order 3, 64 equal contacts: error of A0 [%]", 0.19, ""),),
        "order3_independent": (reported(against.COUNT, len(more), ""), *more),
    }
    return answer("exact", Evidence({k: Evaluated(k, k, "", "A text.", v, (), 1.0) for k, v in rows.items()}))


def test_the_verdict_states_the_documented_error_and_the_worst_of_the_samples():
    headline, sentence = verdict(
        reported(f"a pair, {against.AGAINST}", 1e-4, ""), reported("a pair: uncertainty of A0 [%]", 0.08, "")
    )
    assert headline == "Order 3: A0 of paraboloids to 0.25 %"
    assert "A0 of paraboloids on a half-space by at most 0.25 % where contact radii" in sentence
    assert "the worst of the sampled scenes of paraboloids, 64 equal contacts, has 0.19 %" in sentence
    assert "by at most 0.12 % with up to nine" in sentence
    assert "spheres have 0.21 %, caps of power 3 0.33 % and of power 4 0.38 %" in sentence
    assert "by 0.5 % where contact radii are 0.22 of the distances and by 1.5 % at 0.32" in sentence
    assert "tamaas agrees within 0.01 % on 2 scenes, with an uncertainty of up to 0.08 %" in sentence
    assert "is not installed" in verdict()[1]


def test_the_scenes_of_tamaas_are_unlike_and_inside_the_stated_range():
    scenes = against.scenes()
    assert len(scenes) >= 5
    for scene in scenes.values():
        state = scene.state(scene.expansion(3))
        radius = np.sqrt(state.asperity_area / np.pi)
        apart = np.linalg.norm(scene.surface.position[:, None] - scene.surface.position, axis=2)
        assert (radius / (apart + np.diag([np.inf] * len(radius))).min(axis=1)).max() < 0.32
        assert state.asperity_load.min() > 0.0


def test_without_tamaas_a_row_says_so(monkeypatch):
    monkeypatch.setattr(against, "installed", dict)
    claim = against.claim()
    assert (claim.rows[0].name, claim.rows[0].value) == (against.COUNT, 0)
    assert "tamaas is not installed" in claim.rows[0].method
    # two contacts are compared without it
    assert len(claim.checks) == 2 * len(against.PAIRS)
    assert all(check.passed for check in claim.checks)
    assert not claim.figures


@pytest.mark.slow
def test_order_3_agrees_with_tamaas_on_a_pair():
    pytest.importorskip("tamaas")
    name = "two equal asperities"
    first, third = against.compared(name, 1), against.compared(name, 3)
    assert abs(third.area) < third.uncertain[0] < AREA_ERROR
    assert abs(third.load) < LOAD_ERROR
    assert first.area > 3e-3  # point loads
