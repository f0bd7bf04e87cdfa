"""The header of the page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui
from nicegui.element import Element

from metafem.explorer.answer import Answer
from metafem.explorer.session import State
from metafem.explorer.text.fields import with_field
from metafem.explorer.workshop.editor import load
from metafem.explorer.workshop.header_data import header_data
from metafem.explorer.workshop.new_part_dialog import NewPart
from metafem.files import DEMOS, MODELS, demo_text

if TYPE_CHECKING:
    from metafem.explorer.page import Page

# What the mouse, touch and keys do.
HELP = Path(__file__).with_name("help.html")

# Time after which the header announces an unfinished design [s].
LATE = 0.5


# Explanation of the steps of a design.
SEARCH = "The search for heights begins from several surfaces and improves each of them in steps."


class Header(Element, component="header.js", esm={"metafem-workshop": "js"}):
    """Shows the data of `header_data`; emits an event for each change that it offers."""

    def __init__(self) -> None:
        super().__init__()
        self._props["models"] = list(MODELS)
        self._props["first"] = "independent"
        self._props["demos"] = list(DEMOS)
        self._props["help"] = HELP.read_text("utf-8")


async def begin(page: Page, name: str) -> None:
    """Start again from a demo, or from the first state of the page ("first"), as one step of the history."""
    if name == "first":
        await page.alter(**vars(page.first))
    elif name in DEMOS:
        await page.alter(**vars(State(demo_text(name))))


def header_panel(page: Page) -> Header:
    """Create the header: target in words, status, model, undo, redo, colours and help; return its element.

    Elements created inside the returned element are placed after undo and redo.
    """
    header = Header()
    header.on("undo", page.undo)
    header.on("redo", page.redo)
    header.on("begin", lambda event: begin(page, event.args))
    header.on("load", lambda event: load(page, event.args["files"]))
    header.on("part", NewPart(page).open)
    header.on("model", lambda event: choose(event.args))
    header.on("stop", page.stop)
    shown: dict[str, object] = {"part": ""}

    def tell(data: Mapping[str, object]) -> None:
        """Send the data that have changed to the browser."""
        changed = {name: value for name, value in data.items() if name not in shown or shown[name] != value}
        if changed:
            shown.update(changed)
            header.run_method("show", changed)

    async def choose(model: str) -> None:
        """Change the model of the design."""
        shown["model"] = model  # the browser shows it already
        await page.told(page.make(lambda state: with_field(state.text, "model.kind", model)))

    def show(answer: Answer, found: dict[str, Any]) -> None:
        at, last = page.session.at, len(page.session.states) - 1
        data = {**found, "undo": at > 0, "redo": at < last, "late": False}
        if not answer.state.designs_the_same(page.state):
            data.pop("model", None)  # another one has been chosen
        tell(data)

    def wait() -> None:
        """Show that a design, or a change of the specification, takes longer than `LATE`."""
        queue = page.queue
        change = queue.asked if queue.asked > queue.made else 0
        late = change, max(0, page.number - page.answer.number)
        if any(late) and late == waited.get("for"):
            step = queue.step
            design = f"designing: {step} …" if step else "designing …"
            words = "changing the specification …" if change else design
            meaning = SEARCH if step else ""
            tell({"status": words, "kind": "", "measure": "", "meaning": meaning, "late": True})
        waited["for"] = late

    def warn(places: Mapping[str, list[str]]) -> None:
        """Show why no part can be made; nothing if a part can be made."""
        tell({"part": " ".join(places.get("take", []))})

    waited: dict[str, tuple[int, int]] = {}
    ui.timer(LATE, wait)
    page.listen_prepared(header_data, show)
    page.listen_warnings(warn)
    return header
