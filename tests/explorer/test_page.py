"""A page makes changes in order, keeps its history, and tells its panels the answers."""

import asyncio
import threading
import time

import pytest
from nicegui import Client
from nicegui.page import page as page_of

from metafem.errors import InvalidInput
from metafem.explorer import queue
from metafem.explorer.control import Control, Panel, Request, patience, whole_of
from metafem.explorer.page import build
from metafem.explorer.queue import in_words
from metafem.explorer.session import Session, State
from metafem.files import demo_text
from metafem.progress import doing

TEXT = demo_text("operating-points")


def run(scene):
    """Run a scene on a page whose browser does not answer; return what the scene returns."""

    async def begun():
        client = Client(page_of("/"))
        with client:
            page = Control(State(TEXT))
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
        await page.moved(-1)
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


def waiting(page):
    """Let the computations of a page wait; return the event that starts them, and that of their begin."""
    go, begun, work = threading.Event(), threading.Event(), page.queue.work

    def delayed(request):
        begun.set()
        while not request.stopped and not go.is_set():
            with doing("waiting"):
                time.sleep(0.001)
        return work(request)

    page.queue.work = delayed
    return go, begun


def test_the_first_computation_is_stopped_and_begun_again():
    async def scene(page):
        go, begun = waiting(page)
        await page.alter()
        await asyncio.to_thread(begun.wait, 10.0)
        running = page.running
        await page.stop()
        await shown(page)
        stopped, history = page.answer, page.session
        await page.renew()
        assert page.answer.stopped
        go.set()
        await page.compute()
        await shown(page)
        return running, stopped, history, page.answer

    running, stopped, history, answer = run(scene)
    assert running == (0, 1)
    assert stopped.stopped
    assert (stopped.design, stopped.current, stopped.refused) == (None, False, "")
    assert stopped.specification.target.title == "Friction law through 3 operating points"
    assert len(history.states) == 1
    assert answer.current
    assert not answer.stopped


def test_stopping_keeps_the_state_of_a_page_that_has_shown_nothing_yet():
    async def scene(page):
        page.session = Session((State(TEXT), State(TEXT, newtons=False), State(demo_text("linear"))), 2)
        await page.stop()
        await shown(page)
        return page

    page = run(scene)
    assert page.answer.stopped
    assert page.state == page.answer.state == State(demo_text("linear"))


def test_stopping_after_undo_leads_forward_to_what_is_shown():
    async def scene(page):
        await page.make(with_friction(1.7))
        await shown(page)
        _, begun = waiting(page)
        await page.moved(-1)
        await asyncio.to_thread(begun.wait, 10.0)
        await page.stop()
        await shown(page)
        return page

    page = run(scene)
    assert page.session.at == 1
    assert page.answer.current
    assert not page.answer.stopped


def test_a_draft_stays_when_the_search_after_it_is_stopped():
    async def scene(page):
        await page.make(with_friction(1.7), draft=True)
        await shown(page)
        _, begun = waiting(page)
        await page.make(with_friction(1.7))
        await asyncio.to_thread(begun.wait, 10.0)
        await page.stop()
        await shown(page)
        return page.answer

    answer = run(scene)
    assert answer.current
    assert answer.draft
    assert answer.stopped
    assert '"1.7 mm^2"' in answer.state.text


def test_a_change_that_is_being_made_can_be_stopped():
    async def scene(page):
        begun = threading.Event()

        def endless(state):
            begun.set()
            while True:
                with doing("a change"):
                    time.sleep(0.001)

        change = asyncio.create_task(page.make(endless))
        await asyncio.to_thread(begun.wait, 10.0)
        await page.stop()
        await shown(page)
        return await change, page.state

    assert run(scene) == (None, State(TEXT))


class Each(Panel):
    """Collects the numbers of the answers that are shown, and the warnings."""

    def __init__(self, page):
        super().__init__(page)
        self.shown, self.warned = [], []

    def show(self, answer, _):
        self.shown.append(answer.number)

    def warn(self, places):
        self.warned.append(places)


class Paced(Each):
    """Shows few drafts."""

    pace = 1e3


class Failing(Each):
    """Cannot prepare the first answer, and show no warnings."""

    def prepare(self, answer):
        return 1 / (answer.number - 1)

    def warn(self, places):
        if places:
            raise KeyError(3)


def test_panels_show_answers_with_their_data_and_skip_drafts_that_come_too_fast(caplog):
    words = []

    async def scene(page):
        page.say = words.append
        panels = [kind(page) for kind in (Each, Paced, Failing)]
        for friction in (1.7, 1.71):
            await page.make(with_friction(friction), draft=True)
            await shown(page)
        await page.make(with_friction(1.71))
        await shown(page)
        await page.renew()
        return [panel.shown for panel in panels]

    each, paced, failing = run(scene)
    assert each == [1, 2, 3, 3]
    assert paced == [1, 3, 3]
    assert failing == [2, 3, 3]
    assert [said.partition(":")[2].split(":")[0].strip() for said in words] == ["ZeroDivisionError"]
    assert "ZeroDivisionError" in caplog.text


def test_a_panel_that_has_made_a_change_shows_no_answer_before_it():
    async def scene(page):
        panel, other = Each(page), Each(page)
        before = page.alter(by=other)
        change = page.make(with_friction(1.7), by=panel)
        await asyncio.gather(before, change)
        await shown(page)
        panel.asked = 5
        await page.alter(newtons=False)
        await shown(page)
        await page.renew(other)
        return panel, other

    panel, other = run(scene)
    assert panel.shown == [2]
    assert other.shown[-2:] == [3, 3]


def test_a_panel_that_fails_leaves_the_others_alone(caplog):
    words = []

    async def scene(page):
        page.say = words.append
        panels = [kind(page) for kind in (Each, Failing, Each)]
        page.warn({"law": ["no"]})
        late = Each(page)
        await page.renew(late)
        return [panel.warned for panel in (*panels, late)]

    assert run(scene) == [[{"law": ["no"]}], [], [{"law": ["no"]}], [{"law": ["no"]}]]
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
            tabs = build(State(TEXT)).tabs
        counts = [len(client.elements)]
        for name in ("Take it", "Workshop", "Take it"):
            tabs.set_value(name)
            counts.append(len(client.elements))
        client.delete()
        return counts

    first, opened, *later = asyncio.run(scene())
    assert opened > first
    assert later == [opened, opened]
