"""The models by their names in specifications and on the command line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from difflib import get_close_matches

from metafem._given import printable
from metafem.contact import Contact
from metafem.errors import InvalidInput
from metafem.models import Automatic, BoundaryElements, Independent, Interacting, MeanField, Model
from metafem.models.model import PARABOLOID, with_contact
from metafem.substrate import BondedLayer

# Cell of the named resolved model [mm]: at least eight cells per contact radius at the source paper's
# lightest loads, fifty in its largest contact.
RESOLVED_CELL = 0.008

# Tolerance of A0(P) of the named automatic model: a third of the smallest effect of interaction on the source
# paper's surfaces.
AUTOMATIC_TOLERANCE = 1e-3


def _block() -> Model:
    from metafem.fe import Block3D  # imports scikit-fem, which no other model needs

    return Interacting(substrate=Block3D())


MODELS: Mapping[str, Callable[[], Model]] = {
    "independent": Independent,
    "mean-field": MeanField,
    "half-space": Interacting,
    "layer": lambda: Interacting(substrate=BondedLayer()),
    "block": _block,
    "resolved": lambda: BoundaryElements(cell=RESOLVED_CELL),
    "automatic": lambda: Automatic(tolerance=AUTOMATIC_TOLERANCE),
}


def model_named(name: str, contact: Contact = PARABOLOID) -> Model:
    """Return the model of a name with a contact law; raises InvalidInput with the known names.

    Examples
    --------
    >>> model_named("independent")
    Independent()
    """
    if name not in MODELS:
        words = f"is unknown{suggestion(name, MODELS)}"
        raise InvalidInput(words, key="model", value=f'"{printable(name, 60)}"')
    return with_contact(MODELS[name](), contact)


def suggestion(name: str, known: Mapping[str, object] | tuple[str, ...]) -> str:
    """Return the end of an error: the nearest known name and all of them."""
    near = get_close_matches(name, list(known), 1)
    meant = f"; did you mean {near[0]}?" if near else ""
    return f"{meant} (known: {', '.join(known)})"
