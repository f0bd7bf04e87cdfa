"""Laws of the same surface under further models, and the tolerance band, as they are shown beside the law."""

import asyncio

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.certainty.background import Tasks
from metafem.explorer.law.beside import Beside
from metafem.explorer.law.others import Block, compared, given, law_under, other_law, own_name
from metafem.explorer.law.tools import NO_BLOCK, NO_FORCES, block_data, tools_data
from metafem.explorer.session import State
from metafem.files import demo_text
from metafem.substrate import BondedLayer

TEXT = demo_text("operating-points")


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT, models=("half-space",)), 5)


def test_a_further_law_is_that_of_the_same_surface(answer):
    design = answer.design
    other = other_law(design, "layer")
    model = mf.Interacting(substrate=BondedLayer())
    law = mf.friction_law(design.surface, model, load=design.law.load)
    np.testing.assert_allclose(other.friction, np.interp(other.load, law.rescaled_load, law.area))
    whole = np.sqrt(((law.area / design.law.area - 1.0) ** 2).mean())
    assert other.difference == pytest.approx(whole, rel=0.1)
    assert other.load[-1] == design.law.rescaled_load[-1]
    assert other.words.startswith("layer, differs by ")


def test_the_model_of_the_design_differs_by_nothing(answer):
    assert own_name(answer.design) == "independent"
    assert other_law(answer.design, "independent").difference == pytest.approx(0.0, abs=1e-12)


def test_a_model_without_a_solution_says_why(answer):
    text = TEXT[: TEXT.index("[block]")] + TEXT[TEXT.index("[limits]") :].split("[part]")[0]
    other = other_law(answered(State(text), 1).design, "layer")
    assert "layer" in other.error
    assert not other.load.size


def test_the_plot_gets_the_newest_band_and_laws(answer):
    drawn = []

    async def run():
        beside = Beside(Tasks(), drawn.append)
        beside.put(answer)
        while beside.newest.running:
            await asyncio.sleep(0)
        return beside

    beside = asyncio.run(run())
    (data,) = drawn
    assert data["number"] == 5
    assert [each["name"].split(",")[0] for each in data["others"]] == ["half-space"]
    tolerance = data["tolerance"]
    assert (np.array(tolerance["low"]) <= np.array(tolerance["high"])).all()
    assert "SD" in tolerance["name"]
    assert set(beside.laws) == {"half-space"}


def test_the_law_under_the_block_belongs_to_one_surface(answer):
    block = Block(Tasks(), lambda: None)
    design = answer.design
    assert block.of(design) is None
    block.design = design
    block._found(law_under(design.surface, mf.Independent(), given(design, "independent")[2]))
    assert block.of(design).difference == pytest.approx(0.0, abs=1e-12)
    again = answered(State(TEXT), 6).design
    assert again is not design
    assert block.of(again) is block.law  # after undo
    assert block.of(answered(State(TEXT.replace("0.84", "0.85")), 7).design) is None
    block._failed(mf.errors.NotConverged("no solution"))
    assert block.of(design).error == "block: no solution"
    block.stop()
    assert block.of(design) is None
    assert (
        compared(design, "x", (design.law.rescaled_load[::-3][::-1], design.law.area[::-3][::-1])).difference
        == 0.0
    )


def test_choices_say_what_they_need(answer):
    block = Block(Tasks(), lambda: None)
    tools = tools_data(answer)
    assert tools["kind"] == "operating-points"
    assert tools["no_forces"] == ""
    assert tools["models"] == [{"name": "half-space", "on": True}, {"name": "layer", "on": False}]
    assert tools["block"]
    assert block_data(block, answer.design) == {"running": False, "step": "", "shown": False, "missing": ""}
    text = TEXT.replace("[friction]", "").replace("shear_strength", "# ").replace("area_ratio", "# ")
    text = text[: text.index("[block]")] + text[text.index("[limits]") :].split("[part]")[0]
    bare = answered(State(text), 1)
    assert tools_data(bare)["no_forces"] == NO_FORCES
    assert block_data(block, bare.design)["missing"] == NO_BLOCK
