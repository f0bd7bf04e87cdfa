"""The key figures of an answer as data for their table."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

from metafem.explorer.answer import Answer
from metafem.explorer.certainty import band
from metafem.explorer.certainty.figures import Standing, figures
from metafem.explorer.certainty.long_studies import STUDIES, Found
from metafem.explorer.certainty.places import remarks
from metafem.explorer.session import State
from metafem.notes import Note

NOT_CURRENT = "These are the figures of the last surface that was found, not of the target law that is shown."
# Order of the rows: figures that need attention come first.
ORDER = (Standing.WARNING, Standing.REMARK, Standing.UNKNOWN, Standing.GOOD)

NO_DESIGN = "No surface has been found yet, so there is nothing to judge."


def figure_data(answer: Answer) -> dict[str, Any]:
    """Return the rows of the table, the notes, the text above them and the description of the band."""
    words = NO_DESIGN if answer.design is None else "" if answer.current else NOT_CURRENT
    rows = sorted(figures(answer), key=lambda each: ORDER.index(each.standing))
    return {
        "words": words,
        "rows": [vars(each) for each in rows],
        "notes": _said(remarks(answer)),
        "band": band.band_words(answer),
    }


def at_once(answer: Answer) -> bool:
    """Return whether the figures of an answer can be computed within some tens of milliseconds."""
    return answer.design is not None and answer.design.surface.count <= band.MOST_COUPLED


def study_data(answer: Answer) -> dict[str, Any]:
    """Return a hash of the current state, and for each study why it cannot run, "" if it can."""
    design = answer.design
    reason = "It needs a surface: correct the specification or the target first."
    hindered = {
        name: reason if design is None or not answer.current else study.hindered(design)
        for name, study in STUDIES.items()
    }
    return {"shown": fingerprint(answer.state), "hindered": hindered}


def list_data() -> list[dict[str, str]]:
    """Return names, titles, questions and durations of the studies."""
    return [
        {"key": key, "title": each.title, "question": each.question, "duration": each.duration}
        for key, each in STUDIES.items()
    ]


def found_data(found: Found, fingerprint: str) -> dict[str, Any]:
    """Return the result of a study as data, with the fingerprint of the state that was studied."""
    return {**vars(found), "notes": _said(found.notes), "of": fingerprint}


def _said(notes: tuple[Note, ...]) -> list[dict[str, Any]]:
    """Return notes as data."""
    return [{"text": str(note), "warns": note.warns} for note in notes]


def fingerprint(state: State) -> str:
    """Return a hash of the specification and tables of a state, which determine its design."""
    parts = [state.text, *(part for name in sorted(state.tables) for part in (name, state.tables[name]))]
    return sha256("\0".join(parts).encode("utf-8")).hexdigest()[:16]
