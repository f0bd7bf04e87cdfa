"""The models by the names that people write."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from difflib import get_close_matches

from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.models import Automatic, BoundaryElements, Independent, Interacting, MeanField, Model
from metafem.substrate import BondedLayer

# Cells of the resolved model by name [mm]: eight or more a radius in contacts of the source paper's
# lightest loads, fifty in its widest.
RESOLVED_CELL = 0.008

# Error of A0(P) that the automatic model aims at: a third of what the source paper's interaction costs on
# its most even surface.
AUTOMATIC_TOLERANCE = 1e-3


def _block() -> Model:
    from metafem.fe import Block3D  # with scikit-fem, which no other model needs

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


def model_named(name: str) -> Model:
    """Return the model of a name; raises InvalidInput that lists the known ones.

    Examples
    --------
    >>> model_named("independent")
    Independent()
    """
    if name not in MODELS:
        raise InvalidInput(f'model "{printable(name, 60)}" is unknown{suggestion(name, MODELS)}')
    return MODELS[name]()


def suggestion(name: str, known: Mapping[str, object] | tuple[str, ...]) -> str:
    """Return the end of an error: the nearest known name and all of them."""
    near = get_close_matches(name, list(known), 1)
    meant = f"; did you mean {near[0]}?" if near else ""
    return f"{meant} (known: {', '.join(known)})"
