"""Laws of the same surface under further models, and the tolerance band, as they are shown beside the law."""

import asyncio

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.certainty.background import Tasks
from metafem.explorer.law.further import (
    NO_BLOCK,
    NO_FORCES,
    Block,
    Further,
    other_law,
    own_name,
    tools_data,
)
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
        further = Further(Tasks(), drawn.append)
        further.put(answer)
        while further.newest.running:
            await asyncio.sleep(0)
        return further

    further = asyncio.run(run())
    (data,) = drawn
    assert data["number"] == 5
    assert [each["name"].split(",")[0] for each in data["others"]] == ["half-space"]
    tolerance = data["tolerance"]
    assert (np.array(tolerance["low"]) <= np.array(tolerance["high"])).all()
    assert "SD" in tolerance["name"]
    assert [law.name for law in further.last.laws] == ["half-space"]


class Answering:
    """Tasks of a page that end at once with a value or an error."""

    def __init__(self, value):
        self.value = value

    def start(self, *given):
        done = asyncio.get_running_loop().create_future()
        end = done.set_exception if isinstance(self.value, Exception) else done.set_result
        end(self.value)
        return done

    def running(self, name):
        return False

    def stop(self, name):
        pass


def test_the_law_under_the_block_belongs_to_one_surface(answer):
    design = answer.design
    tasks = Answering(other_law(design, "independent"))
    block = Block(tasks, lambda: None)
    assert block.of(design) is None
    asyncio.run(block.start(design))
    assert block.of(design).difference == pytest.approx(0.0, abs=1e-12)
    again = answered(State(TEXT), 6).design
    assert again is not design
    assert block.of(again) is block.law  # after undo
    assert block.of(answered(State(TEXT.replace("0.84", "0.85")), 7).design) is None
    tasks.value = mf.errors.NotConverged("no solution")
    asyncio.run(block.start(design))
    assert block.of(design).error == "block: no solution"
    block.stop()
    assert block.of(design) is None


@pytest.mark.slow
def test_the_law_under_the_block_is_computed_in_a_process_that_can_be_stopped(answer, monkeypatch):
    monkeypatch.setattr("metafem.explorer.law.further.SLOW", "layer")

    async def run(end):
        states = []
        block = Block(Tasks(), lambda: states.append(block.data(answer.design)))
        task = asyncio.create_task(block.start(answer.design))
        await asyncio.sleep(0)
        if end:
            block.stop()
        await asyncio.gather(task, return_exceptions=True)
        return states

    first, *_, last = asyncio.run(run(end=False))
    assert first == {
        "running": True,
        "step": "The law under the block: starting …",
        "shown": False,
        "missing": "",
    }
    assert last == {"running": False, "step": "", "shown": True, "missing": ""}
    assert asyncio.run(run(end=True))[-1] == {"running": False, "step": "", "shown": False, "missing": ""}


def test_choices_say_what_they_need(answer):
    block = Block(Tasks(), lambda: None)
    tools = tools_data(answer)
    assert tools["no_forces"] == ""
    assert tools["models"] == [{"name": "half-space", "on": True}, {"name": "layer", "on": False}]
    assert tools["block"]
    assert block.data(answer.design) == {"running": False, "step": "", "shown": False, "missing": ""}
    text = TEXT.replace("[friction]", "").replace("shear_strength", "# ").replace("area_ratio", "# ")
    text = text[: text.index("[block]")] + text[text.index("[limits]") :].split("[part]")[0]
    bare = answered(State(text), 1)
    assert tools_data(bare)["no_forces"] == NO_FORCES
    assert block.data(bare.design)["missing"] == NO_BLOCK
