"""What a user should know before making a part."""

from __future__ import annotations

import warnings

from metafem.errors import MetafemWarning
from metafem.inversion import Design, plasticity_index
from metafem.models import equilibrium

# How the notes begin that tell what was done, and warn of nothing.
CALM = (
    "heights stand on steps",
    "heights were moved",
    "the places of the heights were chosen",
    "the places were left as dealt",
    "chosen: ",
)


def is_warning(text: str) -> bool:
    """Whether a note warns of something, and does not only tell what was done."""
    return not text.startswith(CALM)


def cautions(design: Design, hardness: float | None = None) -> tuple[str, ...]:
    """Collect the warnings of a design: its notes, base contact and the plasticity index.

    Parameters
    ----------
    design : Design
    hardness : float, optional
        H of the softer material [MPa]; without it the plasticity index is not evaluated.
    """
    found = list(design.notes)
    found += equilibrium(design.surface, design.law.model, load=float(design.law.load[-1])).notes
    if hardness is not None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", MetafemWarning)
            plasticity_index(design.surface, hardness)
        found += [str(warning.message) for warning in caught]
    return tuple(found)
