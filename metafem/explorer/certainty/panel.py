"""The panel that shows how reliable the design is."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial
from html import escape

from nicegui import ui

from metafem.explorer.answer import Answer
from metafem.explorer.certainty.places import warnings_by_place
from metafem.explorer.certainty.tables import chip, tables_of
from metafem.explorer.control import Control, Panel
from metafem.explorer.queue import Queue

# An answer, and whether it is judged: newer answers follow in a drag.
Request = tuple[Answer, bool]

# Time without a newer answer after which an answer is judged [s]. A drag that stops often goes on within this
# time.
PAUSE = 0.5

# Closes the warnings at the key Escape.
SHUT = "event => { event.currentTarget.open = false; event.currentTarget.firstElementChild.focus(); }"

# Message in place of the tables.
COMPUTED = (
    "The numbers are being computed. The first time after an installation this takes a minute or two, "
    "because parts of the program are compiled then."
)

# Commands that answer further questions about the design, in seconds to minutes, and their questions.
STUDIES = {
    "metafem study manufacturing surface": "How accurate must the heights be?",
    "metafem study misalignment surface": "How level must the plane be?",
    "metafem study uncertainty surface": "Which input matters most?",
    "metafem study fidelity surface": "What do the model, the block and point contacts leave out?",
    "metafem report surface": "Where does all of this stand on one page?",
}
FOLDER = "These commands read the folder of “metafem design spec.toml -o surface”."


class PlaceWarnings(Panel):
    """The warnings of a part of the page, "law" or "surface": how many, and their words over the picture."""

    def __init__(self, page: Control, place: str) -> None:
        super().__init__(page)
        self.place = place
        with ui.element("details").classes("place-warnings").on("keydown.esc", js_handler=SHUT):
            self.brief = ui.html("", sanitize=False, tag="summary")
            self.words = ui.html("", sanitize=False).classes("over")

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings of this part."""
        texts = [text[:1].upper() + text[1:] for text in places.get(self.place, [])]
        brief = re.split(r"[.:;] ", texts[0])[0] if texts else ""
        self.brief.content = f'{chip(texts)}<span class="small">{escape(brief)}</span>' if texts else ""
        self.words.content = "".join(f'<p class="warn small">{escape(text)}</p>' for text in texts)


class Certainty(Panel):
    """The tables of one page, and its warnings; they follow the newest answer after a pause."""

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.answer: Answer | None = None
        self.open = False
        self.queue: Queue[Request, Callable[[], object]] = Queue(
            self._judged,
            lambda show: show(),
            lambda _, error: page.wrong(error),
            better=lambda request: None if request[1] else (request[0], True),
            rest=PAUSE,
        )
        page.client.on_delete(self.queue.stop)

    def create(self) -> Certainty:
        """Create the tables and the commands of studies, when their tab is first opened."""
        with ui.element("div").classes("certainty"):
            with ui.element("section").classes("sure-figures").props('aria-label="How sure"'):
                self.tables = ui.html(f"<p role='status'>{COMPUTED}</p>", sanitize=False)
            with ui.element("section").props('aria-label="Studies"'):
                ui.label(FOLDER).classes("quiet small")
                for command, question in STUDIES.items():
                    ui.label(question)
                    ui.html(f"<pre>{command}</pre>", sanitize=False)
        if self.answer is not None:
            self.queue.put((self.answer, True))
        return self

    def show(self, answer: Answer, _: object) -> None:
        """Follow a new answer."""
        self.answer = answer
        self.queue.put((answer, False))

    def _judged(self, request: Request) -> Callable[[], object]:
        """Return a function that shows the warnings of the answer and, if the tab is open, its tables."""
        answer, judged = request
        if not judged:
            return lambda: None
        return partial(self._show, warnings_by_place(answer), tables_of(answer) if self.open else "")

    def _show(self, places: Mapping[str, list[str]], tables: str) -> None:
        self.page.warn(places)
        if tables:
            self.tables.content = tables
