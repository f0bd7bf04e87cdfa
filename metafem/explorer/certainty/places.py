"""Where the warnings of a design belong on the page."""

from __future__ import annotations

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.certainty.figures import Figure, figures
from metafem.files import planned
from metafem.models.model import contact_of
from metafem.notes import Note
from metafem.report import all_notes

# Beginnings of notes that state what a figure states.
SHOWN_AS_FIGURES = (
    "the base plane would touch",
    "the widest contact",
    "contacts overlap",
    "the elastic interaction",
)

# Keys of the specification by the remedies that notes name.
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

# Words of notes about the part and its contacts; the others are about the law.
OF_THE_SURFACE = ("summit", "caps", "contacts ", "base plane", "the block", "tools")


def remarks(answer: Answer) -> tuple[Note, ...]:
    """Return the notes of the design that an answer shows, warnings first."""
    if answer.design is None:
        return ()
    hardness = None if answer.specification is None else answer.specification.hardness
    return all_notes(answer.design, hardness)


def part_problem(answer: Answer) -> str:
    """Return why no part can be made of the design of an answer, "" where one can."""
    design, specification = answer.design, answer.specification
    if not answer.current or design is None or specification is None:
        return ""
    try:
        planned(design.surface, design.template, specification.part, contact_of(design.law.model))
    except InvalidInput as error:
        return f"no part can be made: {error}"
    return ""


def part_warnings(answer: Answer) -> dict[str, list[str]]:
    """Return why no part can be made at the places where it is told; nothing where one can."""
    problem = part_problem(answer)
    return {"surface": [problem], "take": [problem]} if problem else {}


def warnings_by_place(answer: Answer) -> dict[str, list[str]]:
    """Return the warnings of an answer by where they belong: "law", "surface", "take", or keys.

    "take" is the tab of the files. One warning can belong to several places. Those of an earlier surface,
    which an answer shows where it has none of its own, are none of the present specification.
    """
    if not answer.current:
        return {}
    places = part_warnings(answer)
    warnings = [(figure.places, _text(figure)) for figure in figures(answer) if figure.warns]
    warnings += [
        (_places(str(note)), str(note))
        for note in remarks(answer)
        if note.warns and not str(note).startswith(SHOWN_AS_FIGURES)
    ]
    for names, text in warnings:
        for name in names:
            places.setdefault(name, []).append(text)
    return places


def _text(figure: Figure) -> str:
    bound = f" ({figure.bound})" if figure.bound else ""
    return f"{figure.name}: {figure.value}{bound}. {figure.sentence}"


def _places(text: str) -> tuple[str, ...]:
    part = "surface" if any(word in text for word in OF_THE_SURFACE) else "law"
    return part, *(key for word, key in KEYS.items() if word in text)
