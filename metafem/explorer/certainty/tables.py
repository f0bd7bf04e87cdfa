"""The tables of a design, its notes and the number of its warnings as HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from metafem._values import percent, three_digits
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.certainty.band import band_words
from metafem.inversion import Design
from metafem.notes import Note, counted
from metafem.prediction.validity import BASE, base_contact_load
from metafem.report import all_notes, error_words, fit_table, misfit_words

# Messages in place of the tables and above them.
NO_DESIGN = "No surface has been found yet, so there is nothing to judge."
NOT_CURRENT = "This is about the last surface that was found, not about the target law that is shown."


def tables_of(answer: Answer) -> str:
    """Return what a report states of the design of an answer: its numbers, fitted slopes and notes."""
    design = answer.design
    if design is None:
        return _paragraph(NO_DESIGN)
    columns, rows = fit_table(design)
    fits = _table(zip(columns, *rows, strict=True)) if rows else ""
    notes = remarks(answer)
    above = "" if answer.current else _paragraph(NOT_CURRENT, "warn")
    texts = "".join(map(_note, notes))
    return f"{above}{_table(numbers_of(answer, design))}{fits}<p>{counted(notes)} on the design</p>{texts}"


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


def chip(warnings: Sequence[str]) -> str:
    """Return the number of warnings in a chip."""
    count = f"{len(warnings)} warning{'s' * (len(warnings) > 1)}"
    return f'<span class="chip warn"><span aria-hidden="true">▲</span>{count}</span>'


def _base(design: Design) -> str:
    """Return the load at which the plane touches the base, and the largest load of the law."""
    try:
        onset = base_contact_load(design.surface, design.law.model)
    except MetafemError as error:
        return f"unknown: {error}"
    newtons = design.surface.material.composite_modulus * onset
    return f"{three_digits(newtons)} N; the law ends at {three_digits(design.law.load[-1])} N"


def _table(rows: Iterable[Sequence[str]]) -> str:
    """Return rows as a table whose first cells are headings."""
    lines = (
        f'<tr><th scope="row">{escape(first)}</th>{"".join(map(_cell, others))}</tr>'
        for first, *others in rows
    )
    return f'<div class="scroll"><table class="figure-table"><tbody>{"".join(lines)}</tbody></table></div>'


def _cell(words: str) -> str:
    return f"<td>{escape(words)}</td>"


def _note(note: Note) -> str:
    return _paragraph(f"{'Warning' if note.warns else 'Note'}: {note}", "warn" if note.warns else "note")


def _paragraph(words: str, kind: str = "") -> str:
    return f'<p class="{kind}">{escape(words)}</p>'
