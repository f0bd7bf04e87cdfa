"""The parts of the page where the warnings of a design are shown."""

from __future__ import annotations

from metafem.explorer.answer import Answer
from metafem.explorer.certainty.tables import remarks
from metafem.explorer.text.names import on_page
from metafem.notes import Note

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


def warnings_by_place(answer: Answer) -> dict[str, list[str]]:
    """Return the warnings of an answer by part of the page: "law", "surface", "take" or a specification key.

    "take" is the tab of the files. A warning can belong to several parts. A surface of an earlier state has
    no warnings, because they would not apply to the current specification.
    """
    if not answer.current:
        return {}
    places = {place: [answer.no_part] for place in ("surface", "take") if answer.no_part}
    for note in remarks(answer):
        for name in _places(note) if note.warns else ():
            places.setdefault(name, []).append(on_page(str(note)))
    return places


def _places(note: Note) -> tuple[str, ...]:
    part = "surface" if any(name in OF_THE_SURFACE for name in note.remedies) else "law"
    keys = OF_THE_SURFACE | OF_THE_LAW
    return part, *(keys[name] for name in note.remedies if name in keys)
