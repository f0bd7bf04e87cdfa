"""A page without a browser: what its panels send, and what their buttons, fields and drags change."""

import asyncio
import threading
from dataclasses import replace
from importlib import import_module
from types import SimpleNamespace

import pytest
from nicegui import Client
from nicegui.page import page as page_of

from metafem.errors import InvalidInput
from metafem.explorer import control, queue
from metafem.explorer.answer import Answer
from metafem.explorer.control import Panel, patience, whole_of
from metafem.explorer.editor import Specification, loaded
from metafem.explorer.files import Taking
from metafem.explorer.form import Workshop
from metafem.explorer.header import FIRST, Header
from metafem.explorer.history import Session, State, to_link
from metafem.explorer.law import LawPanel
from metafem.explorer.page import build
from metafem.explorer.surface import SurfacePanel
from metafem.explorer.surface_data import asked_sites
from metafem.explorer.table import with_values
from metafem.files import demo_text, parsed
from tests.explorer.scenes import calls_of, files, held, on_page, shown, with_height

TEXT = demo_text("operating-points")
OWN = f"# for the fair\n{TEXT}"


# A measured law.
FORCES = "load_N,friction_force_N\n0.1,0.12\n0.3,0.4\n"

# Rescaled friction of one newton [mm^2].
UNIT = 1.0 / (0.37 * 0.85)

# What takes long where texts are long or surfaces large.
LONG = [
    "control.answered", "control.to_link", "law.law_data", "law.moved", "law.removed", "law.with_point",
    "editor.read_points", "law.tolerance_band", "surface.site_data", "surface.layout_data",
    "surface.contact_data", "surface.press_data", "surface.edited", "header.header_data",
    "header.with_field", "form.contents", "form.with_kind_near", "files.specification_file",
    "files.made_files",
]  # fmt: skip


@pytest.fixture(autouse=True)
def watched(monkeypatch):
    """Watch that nothing long is called in the event loop, where others would wait for it."""
    called = set()

    def watch(name, function):
        def call(*given, **named):
            called.update({name} if threading.current_thread() is threading.main_thread() else ())
            return function(*given, **named)

        return call

    for name in LONG:
        module, _, function = name.rpartition(".")
        owner = import_module(f"metafem.explorer.{module}")
        monkeypatch.setattr(owner, function, watch(name, getattr(owner, function)))
    yield
    assert called == set()


def friction(value):
    """Return a change that moves the second point."""
    return lambda state: with_values(
        state.table, {"target.rescaled_friction": ["0.84 mm^2", f"{value} mm^2", "4.12 mm^2"]}
    )


def test_a_change_is_a_step_and_a_draft_is_none():
    said = []

    def raised(state):
        return with_values(state.table, {"limits.max_height": "280 um"})

    async def scene(page):
        page.say = lambda words, passing=True: said.append((page.asked, passing))
        numbers, answers = [await page.make(friction(1.7), draft=True)], []
        await shown(page)
        answers.append(page.answer)
        history = [len(page.session.states)]
        numbers += [await page.make(raised), await page.alter(newtons=False)]
        history.append(len(page.session.states))
        await page.moved(-1)
        await shown(page)
        with pytest.raises(InvalidInput, match="TOML"):
            await page.make(lambda state: State("letters").table)
        await shown(page)
        return numbers, history, *answers, page

    numbers, history, draft, page = on_page(scene, state=State(OWN))
    assert (numbers, history) == ([1, 2, 3], [1, 2])
    assert said == [(2, False)]  # comments end with the first edit by hand
    assert draft.draft
    assert '"1.7 mm^2"' in draft.state.text
    assert (page.answer.number, page.state) == (5, State(OWN))
    assert page.answer.design == parsed(TEXT).design()


def test_a_page_begins_with_the_history_of_its_tab_and_the_state_in_its_address(monkeypatch):
    monkeypatch.setattr("metafem.explorer.control.app", SimpleNamespace(storage=SimpleNamespace(tab={})))
    tab, words = control.app.storage.tab, []
    low, high = (State(TEXT.replace("270 um", f"{height} um")) for height in (260, 280))

    async def begun(page, link):
        def address(code, **how):
            found = asyncio.get_running_loop().create_future()
            found.set_result(link)
            return found

        page.client.run_javascript, page.say = address, words.append
        await page._begin()
        await page._begin()  # connected again
        await shown(page)
        return page.session

    def session(link=""):
        return on_page(lambda page: begun(page, link))

    assert session() == tab["session"] == Session((State(TEXT),))
    assert session(f"#{to_link(low)}") == tab["session"] == Session((State(TEXT), low), 1)
    assert session(f"#{to_link(low)}") == Session((State(TEXT), low), 1)  # loaded again
    assert session("#1.eJyr") == Session((State(TEXT), low), 1)
    assert ["link" in each for each in words] == [True]
    tab.clear()  # of a server that was started again
    assert session(f"#{to_link(high)}").state == high


def test_stopping_leads_back_to_what_is_shown():
    async def scene(page):
        free = page.queue.work
        await page.alter()
        await shown(page)
        begun = held(page)
        await page.make(friction(1.7))
        await asyncio.to_thread(begun.wait, 10.0)
        running = page.running
        await page.stop()
        await shown(page)
        back = page.answer
        page.queue.work = free
        await page.make(friction(1.72), draft=True)
        await shown(page)
        begun = held(page)
        await page.make(friction(1.72))
        await asyncio.to_thread(begun.wait, 10.0)
        await page.stop()
        await shown(page)
        return running, back, page.answer

    running, back, draft = on_page(scene)
    assert running == (0, 2)
    assert (back.state.text, back.current, back.stopped, back.number) == (TEXT, True, False, 3)
    assert (draft.current, draft.draft, draft.stopped) == (True, True, True)
    assert '"1.72 mm^2"' in draft.state.text


class Each(Panel):
    """Collects the numbers of the answers that are shown, and the warnings."""

    def __init__(self, page):
        super().__init__(page)
        self.shown, self.warned = [], []
        page.warners.append(self.warn)

    def show(self, answer, _):
        self.shown.append(answer.number)

    def warn(self, places):
        self.warned.append(places)


class Paced(Each):
    pace = 1e3


class Failing(Each):
    """Cannot prepare the first answer, and show no warnings."""

    def prepare(self, answer):
        return 1 / (answer.number - 1)

    def warn(self, places):
        if places:
            raise KeyError(3)


def test_panels_show_what_is_new_and_fail_alone(caplog):
    words = []

    async def scene(page, *panels):
        page.say = words.append
        for value in (1.7, 1.71):
            await page.make(friction(value), draft=True)
            await shown(page)
        await page.make(friction(1.71), by=panels[0])
        panels[0].asked = 5
        await shown(page)
        page.warn({"law": ["no"]})
        await page.renew(panels[1])
        return panels

    each, paced, failing = on_page(scene, Each, Paced, Failing)
    assert (each.shown, paced.shown, failing.shown) == ([1, 2], [1, 3, 3], [2, 3])
    assert (each.warned, failing.warned) == ([{"law": ["no"]}], [])
    assert ["ZeroDivisionError" in words[0], "KeyError: 3" in words[1], len(words)] == [True, True, 2]
    assert "ZeroDivisionError" in caplog.text


def test_a_search_ends_when_the_drag_goes_on_and_a_draft_is_computed_fully_at_rest(monkeypatch):
    one, other = (Answer(1, State(text)) for text in "ab")
    assert patience(one, replace(other, draft=True)) == 0.0
    assert patience(one, replace(one, number=2)) > 1e9
    assert patience(one, other) == patience(replace(one, draft=True), other) == queue.PATIENCE
    assert patience(*[replace(each, draft=True) for each in (one, other)]) == 5.0
    whole = whole_of(replace(one, draft=True))
    assert (whole_of(one), whole.draft, whole.state) == (None, False, one.state)

    async def scene(page):
        page.queue.pause = 0.0
        await page.make(friction(1.7), draft=True)
        while page.answer.draft or page.answer.number < 1:
            await asyncio.sleep(0)
        return page.answer

    assert on_page(scene).current


def test_the_plot_of_the_law_moves_adds_and_removes_points():
    async def scene(page, law):
        sent, texts = calls_of(law), []

        async def event(kind, **given):
            await law._handle(getattr(law, f"on_{kind}"), given)
            await shown(page)
            texts.append(page.state.text)

        await page.alter()
        await shown(page)
        at = {"x": 0.4, "y": 0.6}
        await event("drag", id="point-1", number=7, released=False, **at)
        await event("drag", id="point-1", number=8, released=True, **at)
        await event("add", x=0.6, y=0.7)
        await event("remove", id="point-2")
        await event("drag", id="point-9", number=9, released=True, **at)
        await event("cursor", x=0.272)
        await event("axes", newtons=False)
        await event("pin", on=True)
        await page.step(lambda state: loaded(state, files(m_csv=FORCES), page.answer.template))
        await shown(page)
        await event("measured")
        return sent, texts, page.session.states, page.state

    sent, texts, states, last = on_page(scene, LawPanel)
    drawn = [given[1] for given in sent if given[0] == "draw"]
    assert [each["request"] for each in drawn[:3]] == [0, 7, 8]
    assert texts[0] == TEXT
    target = parsed(texts[1]).target
    assert target.rescaled_load[1] == pytest.approx(0.4 / 1.36, rel=1e-3)
    assert target.rescaled_friction[1] == pytest.approx(0.6 / (0.37 * 0.85), rel=1e-3)
    assert parsed(texts[2]).target.rescaled_load[2] == pytest.approx(0.6 / 1.36, rel=1e-3)
    assert parsed(texts[3]).target.rescaled_load.tolist() == target.rescaled_load.tolist()
    (refused,) = [given for given in sent if given[0] == "refuse"]
    assert (refused[1], "point-9" in refused[2]) == (9, True)
    assert (last.load, last.newtons) == (pytest.approx(0.2), False)
    assert [each["pinned"] is None for each in drawn][-4:] == [True, False, False, False]
    assert (states[-2].measured_name, last.measured) == ("m.csv", "")
    assert drawn[-2]["measured"]["y"] == pytest.approx([0.12 * UNIT, 0.4 * UNIT], rel=1e-4)


def test_the_pictures_of_the_surface_get_what_changed_and_edit_sites():
    async def scene(page, surface):
        sent = calls_of(surface)
        surface.contacts.pause = 0.0
        await page.alter(load=0.3)
        await shown(page)
        while "pressed" not in [name for name, _ in sent]:
            await asyncio.sleep(0)
        await surface._edit({"action": "empty", "sites": [3, 4], "height": ""})
        await shown(page)
        surface._colour("sensitivity")
        while not any("sensitivity" in given for _, given in sent):
            await asyncio.sleep(0)
        return sent, page.answer

    sent, answer = on_page(scene, SurfacePanel)
    first, second = [given for name, given in sent if name == "show"]
    assert len(first["layout"]["x"]) == len(first["height"]) == 64
    assert "layout" not in second
    assert [second["height"][i] for i in (3, 4)] == [None, None]
    assert asked_sites(answer.state.table) == ({}, [3, 4])
    contacts = [given for name, given in sent if name == "contact"]
    assert contacts[0]["load"] == pytest.approx(0.3, rel=1e-9)


def test_an_answer_on_its_way_leaves_what_was_typed():
    async def scene(page, text):
        text.opened()
        text.editor.value = typed = f"# mine\n{TEXT}"
        await page.make(friction(1.7))
        await shown(page)
        kept = text.editor.value == typed
        await text._use()
        await shown(page)
        used = page.state.text == typed
        await page.make(friction(1.7))
        await shown(page)
        return kept, used, text.editor.value == page.state.text != typed

    assert on_page(scene, Specification) == (True, True, True)


def test_header_and_fields_show_what_is_chosen_and_what_is_refused():
    async def scene(page, header, fields):
        bar, sent = calls_of(header), calls_of(fields)
        await page.alter()
        await shown(page)
        bar.clear(), sent.clear()
        steps = (
            lambda: header._choose("half-space"),
            lambda: header._choose("independent"),  # quick
            lambda: fields._typed("limits.max_height", "280"),
            lambda: fields._kind("target", "sampled"),
            lambda: fields._kind("contact", "jkr"),
            lambda: fields._kind("contact", ""),
            lambda: fields._choice("target", 1),
            lambda: header._begin("bilinear"),
            lambda: header._begin("unknown"),
            lambda: header._begin(FIRST),
            lambda: page.alter(text="limits = 3\n"),
            lambda: fields._typed("limits.max_height", "120 um"),
        )
        texts = []
        for step in steps:
            await step()
            await shown(page)
            texts.append(page.state.text)
        page.warn({"limits.offset": ["raise it"]})
        return bar, sent, texts

    bar, sent, texts = on_page(scene, Header, Workshop)
    shown_first = bar[0][1]
    assert ("model" in shown_first, shown_first["solved"], shown_first["undo"]) == (False, "half-space", True)
    assert sent[2][1]["values"]["limits.max_height"] == "280 um"
    tables = [State(text).table for text in texts[:7]]
    assert (tables[0]["model"]["kind"], tables[3]["target"]["kind"]) == ("half-space", "sampled")
    assert (tables[4]["contact"]["kind"], "contact" in tables[5]) == ("jkr", False)
    assert "friction_force" in tables[6]["target"]
    assert texts[7:10] == [demo_text("bilinear")] * 2 + [TEXT]
    (refused,) = [given for name, given in sent if name == "refuse"]
    assert (refused["key"], "limits" in refused["words"]) == ("limits.max_height", True)
    assert sent[-1] == ("show", {"warnings": {"limits.offset": ["raise it"]}})


def test_files_are_taken_or_it_is_said_why_not(monkeypatch):
    taken = {}
    monkeypatch.setattr("nicegui.ui.download.content", lambda content, name: taken.update({name: content}))

    async def scene(page, files):
        await files.take("law.csv")
        before = files.label.text
        await page.alter()
        await shown(page)
        for name in ("spec.toml", "mould.csv"):
            await files.take(name)
        offered = files.offered["mould.csv"][0].enabled
        files.show(with_height(page.answer, 7, 0.0), None)
        return before, files.label.text, offered, files.offered["mould.csv"][0].enabled, files.command.text

    before, after, offered, hindered, command = on_page(scene, Taking)
    assert "metafem design" in command
    assert ("not downloaded" in before, after) == (True, "mould.csv was downloaded.")
    assert (offered, hindered) == (True, False)
    assert list(taken) == ["spec.toml", "mould.csv"]
    assert taken["spec.toml"] == TEXT.encode()
    assert taken["mould.csv"].count(b"\n") > 60


def test_elements_send_what_has_changed_in_one_message():
    sent = []

    async def scene():
        client = Client(page_of("/"))
        with client:
            build(State(TEXT))
            page = control.Control(State(TEXT))
            one, other = Panel(page, {"names": ["a"]}), Panel(page)
        client.run_javascript = sent.append
        one.send({"a": 1, "b": [2]})
        one.send({"a": 1, "b": [3]})
        other.call("draw", [2])
        await asyncio.sleep(0)
        client.delete()
        one.call("draw", [4])
        return one.id, other.id

    one, other = asyncio.run(scene())
    (message,) = sent
    parts = [f'runMethod({one}, \'show\', [{{"a":1,"b":[2]}}])', f"runMethod({one}, 'show', [{{\"b\":[3]}}])"]
    for part, words in zip(message.split(";"), [*parts, f"runMethod({other}, 'draw', [[2]])"], strict=True):
        assert words in part
