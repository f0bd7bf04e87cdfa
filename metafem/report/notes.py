"""What a user should know before making a part."""

from __future__ import annotations

import warnings

from metafem.errors import MetafemWarning
from metafem.inversion import Design, plasticity_index
from metafem.notes import Note


def all_notes(design: Design, hardness: float | None = None) -> tuple[Note, ...]:
    """Return what is to be said of a design, warnings first: its notes and the plasticity index.

    Parameters
    ----------
    design : Design
    hardness : float, optional
        H of the softer material [MPa]; without it the plasticity index is not evaluated.
    """
    found = [*design.notes]
    if hardness is not None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", MetafemWarning)
            plasticity_index(design.surface, hardness)
        found += [Note(str(warning.message)) for warning in caught]
    return tuple(sorted(found, key=lambda note: not note.warns))
