"""The header of the page."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

from nicegui import app, ui

from metafem._values import percent
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.history import State
from metafem.explorer.new_part import new_part_dialog
from metafem.explorer.table import section_of, with_field
from metafem.files import DEMOS, MODELS, demo_text
from metafem.files.specification import AUTOMATIC
from metafem.inversion import Design, DesignStatus
from metafem.inversion.result import misfit_text

# What the mouse, touch and keys do.
HELP = Path(__file__).parent / "static" / "help.html"

# Time after which the header announces an unfinished design [s].
LATE = 0.5

# Name of the first state of the page among the examples to start over from.
FIRST = "as first opened"

# Kind of each status that is not "good": "warn", or "" for neither.
KINDS = {DesignStatus.APPROXIMATE: "", DesignStatus.ADJUSTED: "", DesignStatus.MISSED: "warn"}

STOPPED = "stopped: change something, or compute again"


class Header(Panel, component="static/header.js", esm={"metafem": "static"}):
    """The target in words, the status, the model, undo and redo, and the menu."""

    def __init__(self, page: Control) -> None:
        super().__init__(
            page,
            {"models": list(MODELS), "starts": [FIRST, *DEMOS], "help": HELP.read_text("utf-8")},
            undo=lambda _: page.moved(-1),
            redo=lambda _: page.moved(1),
            begin=self._begin,
            part=lambda _: self.new_part.open(),
            model=self._choose,
            stop=lambda _: page.stop(),
            compute=lambda _: page.moved(0),
        )
        self.running = (0, 0)
        timer = app.timer(LATE, self._wait)  # `ui.timer` would be an element, with a file of its own
        page.client.on_delete(lambda: timer.cancel())

    @cached_property
    def new_part(self) -> ui.dialog:
        """The dialog for a new part, which is created when it is first opened."""
        return new_part_dialog(self.page)

    def prepare(self, answer: Answer) -> dict[str, Any]:
        """Return the data of an answer."""
        return header_data(answer)

    def show(self, answer: Answer, data: dict[str, Any]) -> None:
        """Show an answer, and whether there is something to undo and redo."""
        session = self.page.session
        last = len(session.states) - 1
        self.send({**data, "undo": session.at > 0, "redo": session.at < last, "late": False})

    async def _begin(self, name: str) -> None:
        """Start again from a demo, or from the first state of the page, as one step of the history."""
        if name in (FIRST, *DEMOS):
            begun = self.page.first if name == FIRST else State(demo_text(name))
            await self.page.step(lambda _: begun)

    async def _choose(self, model: str) -> None:
        """Change the model of the design."""
        self.sent["model"] = model  # the browser shows it already
        change = self.page.make(lambda state: with_field(state.table, "model.kind", model), by=self)
        await self.page.told(change)

    def _wait(self) -> None:
        """Show that a design, or a change of the specification, takes longer than `LATE`."""
        running, step = self.page.running, self.page.queue.step
        if any(running) and running == self.running:
            design = f"designing: {step} …" if step else "designing …"
            words = "changing the specification …" if running[0] else design
            self.send({"status": words, "kind": "", "meaning": "", "late": True})
        self.running = running


def header_data(answer: Answer) -> dict[str, Any]:
    """Return the target in words, the status with its kind and meaning, and the model of an answer."""
    status, kind = _status(answer)
    data = {
        "status": status,
        "kind": kind,
        "meaning": answer.refused,
        "stopped": answer.stopped,
        "part": answer.no_part,
    }
    if answer.current and answer.design is not None:
        data["meaning"] = _meaning(answer.design)
    model = section_of(answer.state.known, "model").get("kind", AUTOMATIC)
    if answer.state.known and isinstance(model, str):
        data |= {"model": model, "solved": model}
    if answer.specification is not None:
        data["title"] = answer.specification.target.title
    return data


def _status(answer: Answer) -> tuple[str, str]:
    if answer.stopped:
        return STOPPED, ""
    if answer.failed:
        return "no design: the computation failed", "warn"
    if answer.problems:
        count = len(answer.problems)
        return f"{count} problem{'s' if count > 1 else ''} in the specification", "warn"
    if answer.refusal or answer.design is None:
        return "refused: no surface reaches the target", "warn"
    status = answer.design.status
    words, kind = status.word, KINDS.get(status, "good")
    if answer.simplified:
        words, kind = f"draft under {answer.design.law.model.name}", ""
    if status is not DesignStatus.EXACT:
        words = f"{words}, misfit {misfit_text(answer.design.misfit)}"
    return words, kind


def _meaning(design: Design) -> str:
    """Return the status of a design, what its misfit measures, and the largest good value, as sentences."""
    status, bound = design.status.value, percent(design.largest_misfit, ".3g")
    good = f"The misfit is the {design.misfit_meaning}; up to {bound} is good."
    return f"{status[:1].upper()}{status[1:]}. {good}"
