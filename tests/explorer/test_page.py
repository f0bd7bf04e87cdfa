"""A page makes changes in order, keeps its history, and tells its panels the answers."""

import asyncio

import pytest
from nicegui import Client
from nicegui.page import page as page_of

from metafem.errors import InvalidInput
from metafem.explorer import queue
from metafem.explorer.page import Page, Request, build, patience, whole_of
from metafem.explorer.queue import in_words
from metafem.explorer.session import State
from metafem.files import demo_text

TEXT = demo_text("operating-points")


def run(scene):
    """Run a scene on a page whose browser does not answer; return what the scene returns."""

    async def begun():
        client = Client(page_of("/"))
        with client:
            page = Page(State(TEXT))
        try:
            return await scene(page)
        finally:
            client.delete()

    return asyncio.run(begun())


async def shown(page):
    """Wait until all answers are shown."""
    while page.queue.running:
        await asyncio.sleep(0.001)


def with_friction(value):
    """Return a change that moves the second point."""
    return lambda state: state.text.replace('"1.68 mm^2"', f'"{value} mm^2"')


def test_a_change_is_a_step_and_a_draft_is_none():
    async def scene(page):
        numbers = [await page.make(with_friction(1.7), draft=True)]
        history = [len(page.session.states)]
        await shown(page)
        draft = page.answer
        numbers.append(await page.make(with_friction(1.71)))
        await shown(page)
        numbers.append(await page.alter(newtons=True))
        history.append(len(page.session.states))
        await page.undo()
        await shown(page)
        return numbers, history, draft, page

    numbers, history, draft, page = run(scene)
    assert numbers == [1, 2, 3]
    assert history == [1, 2]
    assert draft.draft
    assert '"1.7 mm^2"' in draft.state.text
    assert page.answer.number == 4
    assert page.answer.state == State(TEXT)


def test_a_draft_is_computed_fully_at_rest(monkeypatch):
    monkeypatch.setattr(queue, "REST", 0.0)

    async def scene(page):
        await page.make(with_friction(1.7), draft=True)
        while page.answer.draft or page.answer.number < 1:
            await asyncio.sleep(0.001)
        return page.answer

    assert run(scene).current


def test_a_refused_change_is_answered_by_the_state_before():
    def refuse(state):
        raise InvalidInput("no")

    async def scene(page):
        await page.alter()
        await shown(page)
        design = page.answer.design
        with pytest.raises(InvalidInput, match="no"):
            await page.make(refuse)
        await shown(page)
        return design, page.answer

    design, answer = run(scene)
    assert answer.number == 2
    assert answer.design is design


def test_stopping_leads_back_to_the_state_that_is_shown():
    async def scene(page):
        await page.alter()
        await shown(page)
        await page.make(with_friction(1.7))
        await page.make(with_friction(1.72))
        await page.stop()
        await shown(page)
        return page.state, page.answer

    state, answer = run(scene)
    assert state.text == answer.state.text == TEXT
    assert answer.number == 4


def test_panels_show_answers_with_their_data_and_skip_drafts_that_come_too_fast(caplog):
    told = {"each": [], "paced": [], "failing": []}

    async def scene(page):
        page.say = told["failing"].append
        page.listen(lambda answer: told["each"].append(answer.number))
        page.listen_prepared(lambda answer: answer.draft, lambda _, draft: told["paced"].append(draft), 1e3)
        page.listen_prepared(lambda answer: 1 / (answer.number - 1), lambda answer, data: None)
        for friction in (1.7, 1.71):
            await page.make(with_friction(friction), draft=True)
            await shown(page)
        await page.make(with_friction(1.71))
        await shown(page)
        page.again()
        await shown(page)

    run(scene)
    assert told["each"] == [1, 2, 3, 3]
    assert told["paced"] == [True, False, False]
    (words,) = told["failing"]
    assert "ZeroDivisionError" in words
    assert "ZeroDivisionError" in caplog.text


def test_a_listener_that_fails_leaves_the_others_alone(caplog):
    told, words = [], []

    def failing(places):
        raise KeyError(3)

    async def scene(page):
        page.say = words.append
        page.listen_warnings(lambda places: told.append(1))
        page.listen_warnings(failing)
        page.listen_warnings(lambda places: told.append(2))
        page.warn({})

    run(scene)
    assert told == [1, 2]
    assert words == [in_words(KeyError(3))]
    assert "not of your input: KeyError: 3. The terminal" in words[0]
    assert "KeyError" in caplog.text


def test_a_full_search_ends_when_the_drag_goes_on_and_is_finished_where_it_ended():
    one, other = (Request(1, State(text), False) for text in "ab")
    assert patience(one, other._replace(draft=True)) == 0.0
    assert patience(one, one._replace(number=2)) > 1e9
    assert (
        0.0
        < patience(one._replace(draft=True), other)
        < patience(*[each._replace(draft=True) for each in (one, other)])
    )
    assert whole_of(one) is None
    assert whole_of(one._replace(draft=True)) == one


def test_what_a_tab_holds_is_created_when_it_is_first_opened():
    async def scene():
        client = Client(page_of("/"))
        with client:
            page = build(State(TEXT))
        counts = [len(client.elements)]
        for name in ("Take it", "Workshop", "Take it"):
            page.tabs.set_value(name)
            counts.append(len(client.elements))
        client.delete()
        return counts

    first, opened, *later = asyncio.run(scene())
    assert opened > first
    assert later == [opened, opened]
