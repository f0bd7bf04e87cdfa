"""Notes on a design for its report."""

from __future__ import annotations

import warnings

from metafem.errors import MetafemWarning
from metafem.inversion import Design, plasticity_index
from metafem.notes import Note


def all_notes(design: Design, hardness: float | None = None) -> tuple[Note, ...]:
    """Return the notes of a design and of its plasticity index, warnings first.

    Parameters
    ----------
    design : Design
    hardness : float, optional
        H of the softer material [MPa]; default: None, the plasticity index is not evaluated.
    """
    found = [*design.notes]
    # a design for a hardness states the index itself
    if hardness is not None and "plasticity_index" not in design.parameters:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", MetafemWarning)
            plasticity_index(design.surface, hardness)
        found += [Note(str(warning.message)) for warning in caught]
    return tuple(sorted(found, key=lambda note: not note.warns))
