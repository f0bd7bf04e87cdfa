"""The parts of the page where the warnings of a design are shown."""

from __future__ import annotations

from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.certainty.figures import Figure, figures
from metafem.explorer.text.names import on_page
from metafem.files import planned
from metafem.notes import Note
from metafem.report import all_notes

# First words of notes that repeat a figure of the table; these notes are not shown again as warnings.
SHOWN_AS_FIGURES = (
    "the base plane would touch",
    "the widest contact",
    "contacts overlap",
    "the elastic interaction",
)

# Words that name a remedy in a note, and the key of the specification for each.
KEYS = {
    "max_height": "limits.max_height",
    "offset": "limits.offset",
    "height_step": "limits.height_step",
    "pitch": "lattice.pitch",
    "radius": "lattice.radius",
    "radii": "lattice.radius",
    "load_range": "target.load_range",
    "hardness": "checks.hardness",
    "the block": "block.width",
    "tilt": "layout.tilt",
}

# Words that occur in notes about the surface; notes without them are about the law.
OF_THE_SURFACE = ("summit", "caps", "contacts ", "base plane", "the block", "tools")


def remarks(answer: Answer) -> tuple[Note, ...]:
    """Return the notes on the design of an answer, warnings first."""
    if answer.design is None:
        return ()
    hardness = None if answer.specification is None else answer.specification.hardness
    return all_notes(answer.design, hardness)


def note_data(notes: tuple[Note, ...]) -> list[dict[str, Any]]:
    """Return notes as data."""
    return [{"text": str(note), "warns": note.warns} for note in notes]


def part_problem(answer: Answer) -> str:
    """Return why no part can be made from the design of an answer; "" if a part can be made."""
    design, specification = answer.design, answer.specification
    if not answer.current or design is None or specification is None:
        return ""
    try:
        planned(design.surface, design.template, specification.part)
    except InvalidInput as error:
        return on_page(f"no part can be made: {error}")
    return ""


def part_warnings(answer: Answer) -> dict[str, list[str]]:
    """Return why no part can be made, by part of the page; an empty dictionary if a part can be made."""
    problem = part_problem(answer)
    return {"surface": [problem], "take": [problem]} if problem else {}


def warnings_by_place(answer: Answer) -> dict[str, list[str]]:
    """Return the warnings of an answer by part of the page: "law", "surface", "take" or a specification key.

    "take" is the tab of the files. A warning can belong to several parts. A surface of an earlier state has
    no warnings, because they would not apply to the current specification.
    """
    if not answer.current:
        return {}
    places = part_warnings(answer)
    warnings = [(figure.places, _text(figure)) for figure in figures(answer) if figure.warns]
    warnings += [
        (_places(str(note)), on_page(str(note)))
        for note in remarks(answer)
        if note.warns and not str(note).startswith(SHOWN_AS_FIGURES)
    ]
    for names, text in warnings:
        for name in names:
            places.setdefault(name, []).append(text)
    return places


def _text(figure: Figure) -> str:
    bound = f" ({figure.bound})" if figure.bound else ""
    return on_page(f"{figure.name}: {figure.value}{bound}. {figure.sentence}")


def _places(text: str) -> tuple[str, ...]:
    part = "surface" if any(word in text for word in OF_THE_SURFACE) else "law"
    return part, *(key for word, key in KEYS.items() if word in text)
