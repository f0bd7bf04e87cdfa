"""The summary of a study: a table of texts, notes and a sentence."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from metafem.notes import Note, from_lines

if TYPE_CHECKING:
    from xarray import Dataset


# The columns of a table by their headings.
Columns = Mapping[str, Iterable[Any]]


@dataclass(frozen=True)
class Summary:
    """The summary of a study: a table of texts, notes and a sentence.

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


def summarised(study: Dataset, title: str, columns: Columns, answer: str = "", *notes: Note) -> Summary:
    """Return the summary of a study from the columns of its table; `notes` precede the notes of the study."""
    rows = tuple(zip(*(map(str, column) for column in columns.values()), strict=True))
    return Summary(title, tuple(columns), rows, (*notes, *stored_notes(study)), answer)


def texts(form: str, values: Iterable[float]) -> list[str]:
    """Return numbers as texts in the same format.

    Examples
    --------
    >>> texts("+.1f", [1.0, -0.26])
    ['+1.0', '-0.3']
    """
    return [f"{value:{form}}" for value in values]


def stored_notes(study: Dataset) -> tuple[Note, ...]:
    """Return the notes of a study."""
    return from_lines(str(study.attrs["notes"]))
