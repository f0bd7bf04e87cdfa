"""The head of the page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui
from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.text.fields import with_field
from metafem.explorer.workshop.editor import load
from metafem.explorer.workshop.header_data import header_data
from metafem.files import MODELS

if TYPE_CHECKING:
    from metafem.explorer.page import Page


# Seconds after which a design that is not finished is announced.
LATE = 0.5


class Header(Element, component="header.js", esm={"metafem-workshop": "js"}):
    """Shows the data of `header_data`, and emits ``model``, ``undo`` and ``redo``."""

    def __init__(self) -> None:
        super().__init__()
        self._props["models"] = list(MODELS)
        self._props["first"] = "independent"


def choose(page: Page, model: str) -> None:
    """Design under another model."""
    try:
        page.edit(with_field(page.state.text, "model.kind", model))
    except InvalidInput as error:
        ui.notify(str(error), type="warning")


def header_panel(page: Page) -> Header:
    """Make the head: the target in words, the status, the model, undo and redo, colours and help.

    What is made within the returned element stands behind undo and redo.
    """
    header = Header()
    header.on("undo", page.undo)
    header.on("redo", page.redo)
    header.on("load", lambda event: load(page, event.args["files"]))
    header.on("model", lambda event: choose(page, event.args))
    shown: dict[str, object] = {}

    def show(answer: Answer) -> None:
        at, last = page.session.at, len(page.session.states) - 1
        data = {**header_data(answer), "undo": at > 0, "redo": at < last}
        changed = {name: value for name, value in data.items() if name not in shown or shown[name] != value}
        if changed:
            shown.update(changed)
            header.run_method("show", changed)

    def wait() -> None:
        """Say that a design takes longer."""
        late = page.number if page.number > page.answer.number else 0
        if late and late == waited.get("for"):
            for name in ("status", "kind", "measure"):
                shown.pop(name, None)
            step = page.newest.step
            header.run_method(
                "show",
                {"status": f"designing: {step} …" if step else "designing …", "kind": "", "measure": ""},
            )
        waited["for"] = late

    waited: dict[str, int] = {}
    ui.timer(LATE, wait)
    page.listen(show)
    return header
