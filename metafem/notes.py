"""Notes: sentences that accompany a result, as a warning or as information.

A note is a warning unless it is made by `information`. The thresholds of the notes are defined next to their
texts, most of them in `prediction/validity.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import Enum
from functools import partial
from typing import Any

# Largest number of asperities and loads of a result whose notes are estimated for printing. The estimate then
# takes at most a few tenths of a second; for a million asperities it would take 17 s.
FEW = 1000


class Level(Enum):
    """Level of a note; its value is the word used in JSON and in datasets."""

    INFORMATION = "information"
    WARNING = "warning"


@dataclass(frozen=True)
class Note:
    """One sentence that accompanies a result, and its level.

    Parameters
    ----------
    text : str
    level : Level
        ``Level.WARNING`` if the result may be wrong or the part may not work; ``Level.INFORMATION`` for
        what the program did, chose or left out.
    quantity : str
        Name of the number that the note is about; "" without a number.
    value, bound : float or None
        This number and the bound with which it is compared, in mm, N and MPa; None if there is none.
    remedies : tuple of str
        Names of the arguments whose change mends what a warning states.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> (note,) = mf.equilibrium(surface, separation=-0.01).notes
    >>> note.level.value, str(note)[:30]
    ('warning', 'the base plane would touch fro')
    >>> note.quantity, note.value, note.remedies
    ('load at which the glass touches the base', 0.08317..., ('offset',))
    """

    text: str
    level: Level = Level.WARNING
    quantity: str = ""
    value: float | None = field(default=None, compare=False)  # equal texts are said once
    bound: float | None = field(default=None, compare=False)
    remedies: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.text

    @property
    def warns(self) -> bool:
        """Whether the note is a warning."""
        return self.level is Level.WARNING

    def to_json(self) -> dict[str, Any]:
        """Return the level, the text and the numbers of the note; without those that it does not have."""
        numbers = {"quantity": self.quantity, "value": self.value, "bound": self.bound}
        given = {name: value for name, value in numbers.items() if value not in ("", None)}
        return {"level": self.level.value, "text": self.text, **given}


def information(text: str, **numbers: Any) -> Note:
    """Return a note with the level `Level.INFORMATION`; `numbers` are further attributes of `Note`."""
    return Note(text, Level.INFORMATION, **numbers)


def counted(notes: Iterable[Note]) -> str:
    """Return text with the numbers of warnings and other notes: ``1 warning, 2 notes``.

    Examples
    --------
    >>> counted([Note("too wide"), information("found in 3 steps")]), counted([])
    ('1 warning, 1 note', 'no notes')
    """
    warnings = [note.warns for note in notes]
    parts = ((warnings.count(True), "warning"), (warnings.count(False), "note"))
    return ", ".join(f"{n} {word}{'s' * (n > 1)}" for n, word in parts if n) or "no notes"


def to_lines(notes: Iterable[Note]) -> str:
    """Return notes as one text for a dataset, with one line for each note: ``information: ...``."""
    return "\n".join(f"{note.level.value}: {note.text}" for note in notes)


def from_lines(text: str) -> tuple[Note, ...]:
    """Return the notes from a text that `to_lines` returned."""
    parts = (line.partition(": ") for line in text.splitlines())
    return tuple(Note(rest, Level(word)) for word, _, rest in parts)


class Late:
    """Descriptor for a value that is set as itself, or as a function that is called at the first read.

    Notes and error estimates are delayed because they take longer than the solution for one equilibrium, and
    most callers do not read them.
    """

    def __init__(self, default: Any) -> None:
        self._default = default

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = f"_{name}"

    def __get__(self, instance: Any, owner: type | None = None) -> Any:
        if instance is None:
            return self._default
        value = instance.__dict__[self._name]
        if callable(value):
            value = instance.__dict__[self._name] = value()
        return value

    def __set__(self, instance: Any, value: Any) -> None:
        instance.__dict__[self._name] = value


def late(default: Any) -> Any:
    """Return a dataclass field whose value may be a function that is called when it is first read."""
    return Late(default)


def when_read(function: Callable[..., Any], *arguments: Any, size: int) -> Any:
    """Return a placeholder for a value that `function` computes; `size` counts asperities and loads."""
    later: Any = partial(function, *arguments)
    later.size = size
    return later


def printed_count(*results: Any) -> str:
    """Return `counted` for the notes of results, or say that they are not estimated if this takes long.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (40, 40), radius=0.526, material=mf.Material(1.36))
    >>> printed_count(mf.equilibrium(surface, load=1.0))
    'notes not estimated yet'
    """
    for result in results:
        notes = result.__dict__["_notes"]
        if callable(notes) and notes.size > FEW:
            return "notes not estimated yet"
    return counted(dict.fromkeys(note for result in results for note in result.notes))
