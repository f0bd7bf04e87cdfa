"""A table of texts and a sentence that summarise a study."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from metafem.notes import Note, from_lines

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True)
class Summary:
    """A table of texts, and a sentence, that summarise a study.

    Attributes
    ----------
    title : str
    columns : tuple of str
        Headings.
    rows : tuple of tuple of str
    notes : tuple of Note
    answer : str
        What the study says about the part, in one sentence; empty for comparisons between models.

    Examples
    --------
    >>> Summary("Change of A0", ("model", "rms [%]"), (("layer", "0.21"),), ()).rows[0]
    ('layer', '0.21')
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[Note, ...]
    answer: str = ""


def stored_notes(study: Dataset) -> tuple[Note, ...]:
    """Return the notes of a study."""
    return from_lines(str(study.attrs["notes"]))
