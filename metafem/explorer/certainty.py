"""How sure a design is: its tolerance band, its numbers and notes, and the places of its warnings."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from html import escape

from nicegui import ui

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, percent, three_digits
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.queue import Queue
from metafem.explorer.table import on_page, places
from metafem.inversion import Design
from metafem.notes import Note, counted
from metafem.prediction.tolerances import scatter
from metafem.prediction.validity import BASE, base_contact_load
from metafem.report import all_notes, error_words, fit_table, misfit_words

# A band is computed at every n-th load of the law: at 34 of 100 loads. Straight
# lines are drawn between them.
EVERY = 3

# Largest numbers of independent and of coupled asperities for a band by linear response. Coupled asperities
# require the solution of n equations at each load, which takes 13 ms for 64 asperities and about a second for
# the largest number.
MOST_ALONE, MOST_COUPLED = 100_000, 400

# Rescaled load, and lowest and highest friction [mm^2].
Band = tuple[FloatArray, FloatArray, FloatArray]


def tolerance_band(answer: Answer) -> Band | None:
    """Return rescaled load, and A0 of manufactured surfaces one standard deviation below and above [mm^2].

    The error of their heights is ``limits.height_sd``. The result is None if the specification states none,
    the surface has too many asperities or the model has no solution.
    """
    design = answer.design
    if design is None or not design.limits.height_sd:
        return None
    model, surface = design.law.model, design.surface
    if surface.count > (MOST_COUPLED if model.couples else MOST_ALONE):
        return None
    load = design.law.rescaled_load[::-EVERY][::-1]
    try:
        mean, sd = scatter(surface, model, load, design.limits.height_sd)
    except MetafemError:  # the model has no solution at these loads
        return None
    return load, mean - sd, mean + sd


def band_words(answer: Answer) -> str:
    """Return the description of the band of an answer; "" if the specification states no errors."""
    deviation = None if answer.design is None else answer.design.limits.height_sd
    if not deviation:
        return ""
    return f"± 1 SD of made surfaces, with errors of the heights of {MICROMETRES * deviation:.3g} µm (SD)"


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
    tables = [numbers_of(answer, design), [*zip(columns, *rows, strict=True)] if rows else []]
    return "".join([above, *map(_table, tables), f"<p>{counted(notes)} on the design</p>", *texts])


def remarks(answer: Answer) -> tuple[Note, ...]:
    """Return the notes on the design of an answer, warnings first."""
    if answer.design is None:
        return ()
    hardness = None if answer.specification is None else answer.specification.hardness
    return all_notes(answer.design, hardness)


def numbers_of(answer: Answer, design: Design) -> list[tuple[str, str]]:
    """Return the numbers that show how reliable a design is, each with its name."""
    misfit, value = misfit_words(design)
    error, _, size = error_words(design.law.model_error).partition(": ")
    words = band_words(answer)
    return [
        (misfit, f"{value}; up to {percent(design.largest_misfit, '.3g')} is good"),
        (error, size),
        (BASE, _base(design)),
        *([("band of the law", words)] if words else []),
    ]


def _base(design: Design) -> str:
    """Return the load at which the plane touches the base, and the largest load of the law."""
    try:
        onset = base_contact_load(design.surface, design.law.model)
    except MetafemError as error:
        return f"unknown: {error}"
    newtons = design.surface.material.composite_modulus * onset
    return f"{three_digits(newtons)} N; the law ends at {three_digits(design.law.load[-1])} N"


def _table(rows: Iterable[Sequence[str]]) -> str:
    """Return rows as a table whose first cells are headings; nothing without rows."""
    lines = []
    for first, *others in rows:
        cells = "".join(f"<td>{escape(each)}</td>" for each in others)
        lines.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    body = f'<table class="figure-table"><tbody>{"".join(lines)}</tbody></table>'
    return f'<div class="scroll">{body}</div>' if lines else ""


# Remedies of notes that concern the surface, not the law, and keys that are not the first of their name.
OF_THE_SURFACE = {"offset", "min_height", "pitch", "radius", "hardness", "width", "length"}
KEYS = {"hardness": "checks.hardness", "model": "model.kind"}


def warnings_by_place(answer: Answer) -> dict[str, list[str]]:
    """Return the warnings of an answer by part of the page: "law", "surface", "take" or a specification key.

    "take" is the tab of the files. A warning can belong to several parts. A surface of an earlier state has
    no warnings, because they would not apply to the current specification.
    """
    if not answer.current:
        return {}
    found = {place: [answer.no_part] for place in ("surface", "take") if answer.no_part}
    for note in remarks(answer):
        for name in _places(note) if note.warns else ():
            found.setdefault(name, []).append(on_page(str(note)))
    return found


def _places(note: Note) -> tuple[str, ...]:
    part = "law" if OF_THE_SURFACE.isdisjoint(note.remedies) else "surface"
    known = {**places(), **KEYS}
    return part, *(known[name] for name in note.remedies if name in known)


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
        count = f"{len(texts)} warning{'s' * (len(texts) > 1)}"
        chip = f'<span class="chip warn"><span aria-hidden="true">▲</span>{count}</span>'
        brief = re.split(r"[.:;] ", texts[0])[0] if texts else ""
        self.brief.content = f'{chip}<span class="small">{escape(brief)}</span>' if texts else ""
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
