"""Results that an earlier version wrote must load for ever.

Each folder of `stored` holds what metafem 0.1.0 wrote: the demos, and designs on a few sites with several
radii, a layout or another model. Those named ``rescaled`` hold laws as rescaled arrays, the older ones in N.
No test writes there. Where a later version renames something, `metafem.files.result.records` reads the old
name.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import metafem as mf
from metafem.files.result.tables import read_surface
from metafem.inversion import DesignStatus

FOLDERS = sorted(path.parent for path in Path(__file__).with_name("stored").glob("*/design.json"))
# Half of the thirteenth digit, the last one of a table.
PRINTED = 0.5e-12


def table(path):
    """Return the columns of a table by their titles."""
    title, *rows = path.read_text(encoding="utf-8").splitlines()
    columns = np.array([row.split(",") for row in rows], dtype=float).T
    return dict(zip(title.split(","), columns, strict=True))


@pytest.fixture(params=FOLDERS, ids=lambda path: path.name)
def folder(request):
    return request.param


def test_all_stored_results_are_found():
    assert len(FOLDERS) == 18


def test_a_stored_design_is_what_its_files_state(folder):
    design = mf.load(folder)
    stated = json.loads((folder / "design.json").read_text(encoding="utf-8"))["design"]
    assert design.status is DesignStatus[stated["status"]["name"]]
    assert design.misfit == stated["misfit"]
    assert_array_equal(design.surface.height, stated["surface"]["height"]["float64"])
    assert_array_equal(design.surface.radius, stated["surface"]["radius"]["float64"])
    assert set(design.parameters) == set(stated["parameters"])
    assert [note.text for note in design.notes] == [note["text"] for note in stated["notes"]]
    surface = read_surface(folder / "heights.csv", design.surface.material)
    assert_allclose(surface.position, design.surface.position, rtol=PRINTED)
    assert_allclose(surface.height, design.surface.height, rtol=PRINTED)
    assert_allclose(surface.radius, design.surface.radius, rtol=PRINTED)
    law = table(folder / "law.csv")
    for title, values in (
        ("load_N", design.law.load),
        ("area_mm2", design.law.area),
        ("separation_mm", design.law.separation),
        ("rescaled_load_mm2", design.law.rescaled_load),
        ("rescaled_friction_mm2", design.law.rescaled_friction),
        ("friction_force_N", design.law.friction_force),
    ):
        assert_allclose(values, law[title], rtol=PRINTED)


# Laws whose models have changed since: areas of resolved contacts were once the number of their cells, which
# jumps by up to this fraction; `Automatic` may choose another model within its tolerance.
# First of the area, then of the other quantities.
CHANGED = {"points-resolved": (0.02, 1e-12), "multilinear-automatic": (1e-3, 1e-3)}


def test_the_law_of_a_stored_design_is_predicted_again(folder):
    """The equations are the same; only the order of sums and the last Newton step may differ.

    Every ninth load is enough, and shows that a state does not depend on the loads before it.
    """
    design = mf.load(folder)
    stored = design.law
    law = mf.friction_law(design.surface, stored.model, load=stored.load[::9])
    of_area, of_others = CHANGED.get(folder.name, (1e-12, 1e-12))
    assert_allclose(law.area, stored.area[::9], rtol=of_area)
    for name in ("separation", "approach"):
        assert_allclose(getattr(law, name), getattr(stored, name)[::9], rtol=of_others)
    # the inner iteration may stop a step earlier or later, which costs the square of its tolerance
    assert_allclose(law.stiffness, stored.stiffness[::9], rtol=max(1e-7, of_others))
    assert law.status is stored.status
    assert law.model == stored.model
