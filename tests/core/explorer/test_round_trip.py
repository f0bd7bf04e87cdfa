"""A specification, its answer, an edit, the answer to it, and undo: over all kinds of targets."""

import pytest

from metafem.explorer.handles import moved, scene_of
from metafem.explorer.history import State, from_link, to_link
from metafem.explorer.kinds import with_kind_near
from metafem.explorer.surface_data import edited
from metafem.explorer.table import with_field
from metafem.files import parsed
from tests.explorer.scenes import TABLE, TABLES, on_page, shown, text_of


def dragged(state, answer):
    """Move the last handle."""
    scene = scene_of(state, answer.specification, answer.design)
    handle = scene.handles()[-1]
    return moved(scene, handle.id, 1.01 * handle.load, 0.99 * handle.friction)


def kept(state, answer):
    """Keep the height of the first asperity."""
    site = int(answer.design.sites[0])
    return edited(state.table, answer.design, {"action": "pin", "sites": [site], "height": ""})


# Targets, edits of them, and the section that each edit changes.
EDITS = {
    "power": (dragged, "target"),
    "table": (kept, "sites"),
    "linear": (lambda state, _: with_field(state.table, "limits.max_height", "0,13 mm"), "limits"),
    "bilinear": (lambda state, answer: with_kind_near(state, answer.design, "sampled"), "target"),
}


@pytest.mark.parametrize("name", EDITS)
def test_undo_gives_back_the_text_and_its_design(name):
    change, section = EDITS[name]
    first = State(text_of(name), {"wanted.csv": TABLE})

    async def scene(page):
        answers = []
        for step in (
            page.alter,
            lambda: page.make(lambda state: change(state, page.answer)),
            lambda: page.moved(-1),
        ):
            await step()
            await shown(page)
            answers.append(page.answer)
        await page.moved(1)
        return *answers, page.state

    before, after, undone, redone = on_page(scene, state=first)
    assert [each.number for each in (before, after, undone)] == [1, 2, 3]
    assert (before.state, undone.state, redone) == (first, first, after.state)
    assert undone.current
    assert undone.design == before.design == parsed(first.text, TABLES).design()
    assert after.current
    assert after.design == parsed(after.state.text, TABLES).design()
    old, new = ({**each.state.table} for each in (before, after))
    assert old.pop(section, None) != new.pop(section)
    assert new == old
    assert from_link(to_link(after.state)) == after.state
