"""What a result says beside its numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum


class Level(Enum):
    """What a note is; the value is the word before it."""

    INFORMATION = "information"
    WARNING = "warning"


@dataclass(frozen=True)
class Note:
    """One sentence beside a result, and whether it warns.

    Parameters
    ----------
    text : str
    level : Level
        ``Level.WARNING`` where the result may be wrong or the part may not work; ``Level.INFORMATION`` for
        what was done, chosen or left out.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> (note,) = mf.equilibrium(surface, separation=-0.01).notes
    >>> note.level.value, str(note)[:30]
    ('warning', 'the base plane would touch: se')
    """

    text: str
    level: Level = Level.WARNING

    def __str__(self) -> str:
        return self.text

    @property
    def warns(self) -> bool:
        """Whether it is a warning."""
        return self.level is Level.WARNING


def information(text: str) -> Note:
    """Return a note that warns of nothing."""
    return Note(text, Level.INFORMATION)


def counted(notes: Iterable[Note]) -> str:
    """Return how many notes there are of each level: ``1 warning, 2 notes``.

    Examples
    --------
    >>> counted([Note("too wide"), information("found in 3 steps")]), counted([])
    ('1 warning, 1 note', 'no notes')
    """
    warnings = [note.warns for note in notes]
    parts = ((warnings.count(True), "warning"), (warnings.count(False), "note"))
    return ", ".join(f"{n} {word}{'s' * (n > 1)}" for n, word in parts if n) or "no notes"


def to_lines(notes: Iterable[Note]) -> str:
    """Return notes as one text for a data set, a line for each: ``information: ...``."""
    return "\n".join(f"{note.level.value}: {note.text}" for note in notes)


def from_lines(text: str) -> tuple[Note, ...]:
    """Return the notes that `to_lines` wrote."""
    parts = (line.partition(": ") for line in text.splitlines())
    return tuple(Note(rest, Level(word)) for word, _, rest in parts)
