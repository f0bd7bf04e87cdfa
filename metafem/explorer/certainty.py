"""How sure a design is: its tolerance band, its numbers and notes, and the places of its warnings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from nicegui import ui

from metafem._validate import FloatArray
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.queue import Queue
from metafem.explorer.table import names
from metafem.notes import Note, counted
from metafem.prediction.tolerances import scatter
from metafem.report import all_notes, fit_table, numbers

# A band is computed at every n-th load of the law: at 34 of 100 loads. Straight
# lines are drawn between them.
EVERY = 3

# Rescaled load, and lowest and highest friction [mm^2].
Band = tuple[FloatArray, FloatArray, FloatArray]


def tolerance_band(answer: Answer) -> Band | None:
    """Return rescaled load, and mean A0 of made surfaces minus and plus one standard deviation [mm^2].

    The error of their heights is ``limits.height_sd``. The result is None if the specification states none,
    the surface has too many asperities or independent asperities have no solution.
    """
    design = answer.design
    if design is None or not design.limits.height_sd:
        return None
    law = design.law
    load, area = law.rescaled_load[::-EVERY][::-1], law.area[::-EVERY][::-1]
    try:
        mean, sd = scatter(design.surface, law.model, load, design.limits.height_sd)
    except MetafemError:  # too many asperities, or no solution at these loads
        return None
    return load, area * (mean - sd), area * (mean + sd)


# Messages in place of the tables and above them.
NO_DESIGN = "No surface has been found yet, so there is nothing to judge."
NOT_CURRENT = "This is about the last surface that was found, not about the target law that is shown."


def tables_of(answer: Answer) -> str:
    """Return what a report states of the design of an answer: its numbers, fitted slopes and notes."""
    design = answer.design
    if design is None:
        return f"<p>{NO_DESIGN}</p>"
    columns, rows = fit_table(design)
    notes = remarks(answer)
    texts = [
        f'<p class="{"warn" if note.warns else "note"}">{"Warning" if note.warns else "Note"}: '
        f"{escape(str(note))}</p>"
        for note in notes
    ]
    above = "" if answer.current else f'<p class="warn">{NOT_CURRENT}</p>'
    judged = _table((name, value) for value, name in numbers(design))
    fits = _table(zip(columns, *rows, strict=True)) if rows else ""
    return "".join([above, judged, fits, f"<p>{counted(notes)} on the design</p>", *texts])


def remarks(answer: Answer) -> tuple[Note, ...]:
    """Return the notes on the design of an answer, warnings first."""
    hardness = None if answer.specification is None else answer.specification.hardness
    return () if answer.design is None else all_notes(answer.design, hardness)


def _table(rows: Iterable[Sequence[str]]) -> str:
    """Return rows as a table whose first cells are headings."""
    lines = []
    for first, *others in rows:
        cells = "".join(f"<td>{escape(each)}</td>" for each in others)
        lines.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    return f'<div class="scroll"><table class="figure-table"><tbody>{"".join(lines)}</tbody></table></div>'


# Remedies of notes that concern the surface, not the law, and keys that are not the first of their name.
OF_THE_SURFACE = {"offset", "min_height", "pitch", "radius", "hardness", "width", "length"}
KEYS = {"hardness": "checks.hardness", "model": "model.kind", "height_sd": "limits.height_sd"}


def warnings_by_place(answer: Answer) -> dict[str, list[str]]:
    """Return the warnings of an answer by part of the page: "law", "surface" or a specification key.

    A warning can belong to several parts. A surface of an earlier state has
    no warnings, because they would not apply to the current specification.
    """
    if not answer.current:
        return {}
    found = {"surface": [answer.no_part]} if answer.no_part else {}
    for note in remarks(answer):
        for name in _places(note) if note.warns else ():
            found.setdefault(name, []).append(str(note))
    return found


def _places(note: Note) -> tuple[str, ...]:
    part = "law" if OF_THE_SURFACE.isdisjoint(note.remedies) else "surface"
    known = {name.rpartition(".")[2]: name for name in reversed(names())} | KEYS
    return part, *(known[name] for name in note.remedies if name in known)


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
    "metafem study misalignment surface": "How level must the glass be?",
    "metafem study uncertainty surface": "Which input matters most?",
    "metafem study fidelity surface": "What do the model, the block and point contacts leave out?",
    "metafem report surface": "Where does all of this stand on one page?",
}
FOLDER = "These commands read the folder of “metafem design spec.toml -o surface”."


def place_warnings(page: Control, place: str) -> None:
    """Make the warnings of a part, "law" or "surface": how many, and their words over the picture."""
    with ui.element("details").classes("place-warnings").on("keydown.esc", js_handler=SHUT):
        brief = ui.html("", sanitize=False, tag="summary")
        words = ui.html("", sanitize=False).classes("over")

    def warn(places: Mapping[str, list[str]]) -> None:
        texts = [escape(text[:1].upper() + text[1:]) for text in places.get(place, [])]
        count = f"{len(texts)} warning{'s' * (len(texts) > 1)}"
        chip = f'<span class="chip warn"><span aria-hidden="true">▲</span>{count}</span>'
        first = re.split(r"[.:;] ", texts[0])[0] if texts else ""
        brief.content = f'{chip}<span class="small">{first}</span>' if texts else ""
        words.content = "".join(f'<p class="warn small">{text}</p>' for text in texts)

    page.warners.append(warn)


# The warnings of an answer by part of the page, and its tables.
Judged = tuple[Mapping[str, list[str]], str]


class Certainty(Panel):
    """The tables of one page, and its warnings, which follow each full answer."""

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.queue: Queue[Answer, Judged] = Queue(
            lambda answer: (warnings_by_place(answer), tables_of(answer)),
            self._show,
            lambda _, error: page.wrong(error),
        )
        page.client.on_delete(self.queue.stop)
        self.classes("certainty")
        with self:
            with ui.element("section").classes("sure-figures").props('aria-label="How sure"'):
                self.tables = ui.html(f"<p role='status'>{COMPUTED}</p>", sanitize=False)
            with ui.element("section").props('aria-label="Studies"'):
                ui.label(FOLDER).classes("quiet small")
                for command, question in STUDIES.items():
                    ui.label(question)
                    ui.html(f"<pre>{command}</pre>", sanitize=False)

    def show(self, answer: Answer, _: object) -> None:
        """Judge a new answer, unless a drag goes on."""
        if not answer.draft:
            self.queue.put(answer)

    def _show(self, judged: Judged) -> None:
        places, self.tables.content = judged
        self.page.warn(places)
