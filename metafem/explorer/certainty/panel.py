"""The panel that shows how reliable the design is."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial
from html import escape
from typing import Any

from nicegui import background_tasks, ui

from metafem.explorer.answer import Answer
from metafem.explorer.certainty import band
from metafem.explorer.certainty.figures import Standing, figures
from metafem.explorer.certainty.places import part_warnings, remarks, warnings_by_place
from metafem.explorer.certainty.table import chip, figure_table, note_list
from metafem.explorer.control import Control, Panel
from metafem.explorer.queue import Queue

# An answer and what is computed for it: nothing, because newer answers follow in a drag; then the figures;
# and then random surfaces within the tolerances. Each follows when the page rests after the one before.
Request = tuple[Answer, int]
NOTHING, FIGURES, DRAWS = range(3)

# Time without a newer answer after which the next of these begins [s]. A drag that stops often goes
# on within this time, and draws would delay its first steps.
PAUSE = 0.5

# Closes the warnings at the key Escape.
SHUT = "event => { event.currentTarget.open = false; event.currentTarget.firstElementChild.focus(); }"

# Messages in place of the table and above it.
COMPUTED = (
    "The figures are being computed. The first time after an installation this takes a minute or two, "
    "because parts of the program are compiled then."
)
NO_DESIGN = "No surface has been found yet, so there is nothing to judge."
NOT_CURRENT = "These are the figures of the last surface that was found, not of the target law that is shown."

# Commands that answer further questions about the design, in seconds to minutes, and their questions.
STUDIES = {
    "metafem study manufacturing surface": "How accurate must the heights be?",
    "metafem study misalignment surface": "How level must the plane be?",
    "metafem study uncertainty surface": "Which input matters most?",
    "metafem study fidelity surface": "What do the model, the block and point contacts leave out?",
    "metafem report surface --checks": "Do the finite elements meet closed forms? The report shows it all.",
}
FOLDER = "These commands read the folder of “metafem design spec.toml -o surface”."

# Order of the rows: figures that need attention come first.
ORDER = (Standing.WARNING, Standing.REMARK, Standing.UNKNOWN, Standing.GOOD)


def figure_data(answer: Answer) -> dict[str, Any]:
    """Return the rows of the table, the notes as HTML, the text above and the description of the band."""
    return {
        "words": NO_DESIGN if answer.design is None else "" if answer.current else NOT_CURRENT,
        "rows": sorted(map(vars, figures(answer)), key=lambda row: ORDER.index(row["standing"])),
        "notes": note_list(remarks(answer)),
        "band": band.band_words(answer),
    }


def at_once(answer: Answer) -> bool:
    """Return whether the figures of an answer can be computed within some tens of milliseconds."""
    return answer.design is not None and answer.design.surface.count <= band.MOST_COUPLED


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
        count = chip(Standing.WARNING, f"{len(texts)} warning{'s' * (len(texts) > 1)}")
        self.brief.content = f'{count}<span class="small">{escape(brief)}</span>' if texts else ""
        self.words.content = "".join(f'<p class="warn small">{escape(text)}</p>' for text in texts)


class Certainty(Panel):
    """The figures of one page, and its warnings; they follow the newest answer after a pause."""

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.answer: Answer | None = None
        self.open = False
        self.queue: Queue[Request, Callable[[], object]] = Queue(
            self._judged,
            lambda show: show(),
            lambda _, error: page.wrong(error),
            better=self._next,
            rest=PAUSE,
        )
        page.client.on_delete(self.queue.stop)

    def create(self) -> Certainty:
        """Create the table of the figures and the commands of studies, when their tab is first opened."""
        with ui.element("div").classes("certainty"):
            with ui.element("section").classes("sure-figures").props('aria-label="How sure"'):
                self.table = ui.html(f"<p role='status'>{COMPUTED}</p>", sanitize=False)
                with ui.element("details").props("open"):
                    self.count = ui.html("", sanitize=False, tag="summary")
                    self.notes = ui.html("", sanitize=False)
            with ui.element("section").props('aria-label="Studies"'):
                ui.label(FOLDER).classes("quiet small")
                for command, question in STUDIES.items():
                    ui.label(question)
                    ui.html(f"<pre>{command}</pre>", sanitize=False)
        if self.answer is not None:
            self.queue.put((self.answer, FIGURES))
        return self

    def show(self, answer: Answer, _: object) -> None:
        """Follow a new answer."""
        self.answer = answer
        self.queue.put((answer, NOTHING))

    def _next(self, request: Request) -> Request | None:
        """Return the request that follows when the page rests; random surfaces are drawn once."""
        answer, wanted = request
        ended = wanted == DRAWS or (wanted == FIGURES and band.drawn_of(answer) is not None)
        return None if ended else (answer, wanted + 1)

    def _judged(self, request: Request) -> Callable[[], object]:
        """Return a function that shows the warnings of the answer and, if the tab is open, its figures.

        While the tab is closed, a large surface gets only the warnings about its part. After draws, all
        panels show the answer once more, with their band.
        """
        answer, wanted = request
        if wanted == DRAWS and band.draw(answer) is not None:
            return lambda: background_tasks.create(self.page.renew())
        if wanted != FIGURES:
            return lambda: None
        places = (warnings_by_place if self.open or at_once(answer) else part_warnings)(answer)
        data = figure_data(answer) if self.open else None
        return partial(self._show, places, data)

    def _show(self, places: Mapping[str, list[str]], data: dict[str, Any] | None) -> None:
        self.page.warn(places)
        if data is not None:
            self.table.content = figure_table(data)
            self.count.content, self.notes.content = data["notes"]
