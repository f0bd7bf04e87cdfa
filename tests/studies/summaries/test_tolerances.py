"""How exact heights and plane must be, in words."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.summaries.tolerances import shown
from tests.conftest import MATERIAL, RADIUS


@pytest.mark.parametrize(("count", "step"), [(1, 1), (12, 1), (13, 2), (31, 5), (1000, 100)])
def test_a_table_has_at_most_twelve_rows_and_the_last(count, step):
    rows = shown(count)
    assert (rows[-1], len(rows) <= 12, set(np.diff(rows)) <= {step}) == (count - 1, True, True)


@pytest.fixture(scope="module")
def surface():
    height = 0.2 - 0.02 * np.log(64 / (np.arange(64) + 0.5))
    return mf.Surface.square_lattice(height, radius=RADIUS, material=MATERIAL)


def test_scatter_and_change_of_the_mean_are_sentences_of_their_own(surface):
    found = mf.studies.summary(mf.studies.manufacturing(surface, 0.003, draws=1000))
    limit, scatter, mean = found.answer.removesuffix(".").split(". ")
    assert limit.startswith("With errors of the heights of up to ")
    assert limit.endswith(" µm (± two standard errors)")
    assert "µm (SD) the slope scatters by less than 1 % (SD); this limit lies between " in limit
    assert scatter.startswith("At 3 µm (SD) the slope scatters by ")
    assert mean.startswith("The mean slope changes there by ")


def test_no_limit_is_stated_where_there_is_none(surface):
    one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL)
    made = {"height_sd": 0.001, "draws": 64}
    found = mf.studies.manufacturing(one, **made, load_range=(0.01, 0.02))
    assert np.isinf(found.largest_height_sd)
    assert mf.studies.summary(found).answer.startswith(
        "No errors were found with which the slope scatters by"
    )
    found = mf.studies.misalignment(one, 0.01, load_range=(0.01, 0.02))
    assert mf.studies.summary(found).answer.startswith(
        "No errors were found with which the slope scatters by"
    )
    few = surface.replaced(position=surface.position[:4], height=surface.height[::16], radius=RADIUS)
    found = mf.studies.manufacturing(few, **made, others=mf.Tolerances(radius_sd=0.05))
    assert np.isnan(found.largest_height_sd)
    assert mf.studies.summary(found).answer.startswith("No errors are small enough for a slope")
    few = mf.studies.summary(mf.studies.manufacturing(surface, 0.001, draws=8)).answer
    assert few.startswith("The draws are too few to state with which errors")


def test_a_misfit_of_rounding_is_none(template):
    design = mf.design(mf.OperatingPoints([0.0747], [0.642]), template)
    found = mf.studies.summary(mf.studies.combined(design, mf.Tolerances(height_sd=0.003), draws=64))
    assert found.notes[0].text.startswith("misfit 0 % without errors; median of the surfaces")
    assert found.title.startswith("Target met within 10 %: probability")
