"""The parts of the page where the warnings of a design are shown."""

from __future__ import annotations

from metafem.explorer.answer import Answer
from metafem.explorer.certainty.figures import Figure, figures
from metafem.explorer.text.names import on_page
from metafem.notes import Note
from metafem.prediction.validity import BASE, INTERACTION, OVERLAPS, WIDTH
from metafem.report import all_notes

# Quantities of notes that repeat a figure of the table; these notes are not shown again as warnings.
SHOWN_AS_FIGURES = (BASE, WIDTH, OVERLAPS, INTERACTION)

# Remedies of notes about the surface, and of notes about the law, with the key of the specification for each.
OF_THE_SURFACE = {
    "offset": "limits.offset",
    "min_height": "limits.offset",
    "pitch": "lattice.pitch",
    "radius": "lattice.radius",
    "hardness": "checks.hardness",
    "width": "block.width",
    "length": "block.length",
}
OF_THE_LAW = {
    "max_height": "limits.max_height",
    "load_range": "target.load_range",
    "slope": "target.slope",
    "model": "model.kind",
    "pinned": "sites.pinned",
}


def remarks(answer: Answer) -> tuple[Note, ...]:
    """Return the notes on the design of an answer, warnings first."""
    if answer.design is None:
        return ()
    hardness = None if answer.specification is None else answer.specification.hardness
    return all_notes(answer.design, hardness)


def part_warnings(answer: Answer) -> dict[str, list[str]]:
    """Return why no part can be made, by part of the page; an empty dictionary if a part can be made."""
    return {place: [answer.no_part] for place in ("surface", "take") if answer.no_part}


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
        (_places(note), on_page(str(note)))
        for note in remarks(answer)
        if note.warns and note.quantity not in SHOWN_AS_FIGURES
    ]
    for names, text in warnings:
        for name in names:
            places.setdefault(name, []).append(text)
    return places


def _text(figure: Figure) -> str:
    bound = f" ({figure.bound})" if figure.bound else ""
    return on_page(f"{figure.name}: {figure.value}{bound}. {figure.sentence}")


def _places(note: Note) -> tuple[str, ...]:
    part = "surface" if any(name in OF_THE_SURFACE for name in note.remedies) else "law"
    keys = OF_THE_SURFACE | OF_THE_LAW
    return part, *(keys[name] for name in note.remedies if name in keys)
