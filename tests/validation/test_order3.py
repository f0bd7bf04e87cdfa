"""The stated error of order 3, and its comparison with tamaas."""

import re
from pathlib import Path

import numpy as np

import metafem as mf
from validation.cost import model_table
from validation.fidelity import order3_independent as against
from validation.readme import README
from validation.scenes.models import (
    AREA_ERROR,
    CAP_ERROR,
    CAP_LOAD_ERROR,
    FEW_ERROR,
    LAYER_ERROR,
    LOAD_ERROR,
)

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
