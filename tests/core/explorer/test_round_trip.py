"""A specification, its answer, an edit, the answer to it, and undo: over all kinds of targets."""

import pytest

from metafem.explorer.history import State, from_link, to_link
from metafem.files import demo_text, parsed
from tests.explorer.scenes import EDITS, TABLE, TABLES, on_page, shown, text_of


@pytest.mark.parametrize(
    ("name", "edit"),
    [
        ("demo", "drag"),
        ("table", "height"),
        ("linear", "field"),
        ("line", "units"),
        ("bilinear", "kind"),
        ("power", "drag"),
        pytest.param("multilinear", "section", marks=pytest.mark.slow),
    ],
)
def test_undo_gives_back_the_text_and_its_design(name, edit):
    change, section = EDITS[edit]
    text = demo_text("operating-points") if name == "demo" else text_of(name)
    first = State(text, {"wanted.csv": TABLE})

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
