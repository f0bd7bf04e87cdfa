"""Specifications: the names of models and demonstrations here, the sections and their reading in modules."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from importlib.resources import files
from typing import TYPE_CHECKING

import metafem as mf
from metafem.errors import InvalidInput, printable

if TYPE_CHECKING:
    from metafem.contact import Contact
    from metafem.material import Block
    from metafem.models import Model

# Cell size of the model "resolved" [mm]. A contact radius has at least eight cells at the source paper's
# smallest loads, and fifty in its largest contact.
RESOLVED_CELL = 0.008

# Name of the model of a specification that states none.
AUTOMATIC = "automatic"

# Relative tolerance of A0(P) of the model "automatic": a third of the smallest effect of interaction on the
# source paper's surfaces.
AUTOMATIC_TOLERANCE = 1e-3


# Functions that return the models. The models are not made here, because their import would delay the
# command, which at first needs only their names.
MODELS: Mapping[str, Callable[[], Model]] = {
    "independent": lambda: mf.Independent(),
    "half-space": lambda: mf.Interacting(),
    "layer": lambda: mf.Interacting(substrate=mf.BondedLayer()),
    "block": lambda: mf.Interacting(substrate=mf.fe.Block3D()),
    "resolved": lambda: mf.BoundaryElements(cell=RESOLVED_CELL),
    AUTOMATIC: lambda: mf.Automatic(tolerance=AUTOMATIC_TOLERANCE),
}


# Names of the specifications that come with the package.
DEMOS = ("operating-points", "linear", "bilinear")


def model_named(name: str, contact: Contact | None = None, block: Block | None = None) -> Model:
    """Return the named model with a contact law; raise InvalidInput for an unknown name.

    The default contact law is Hertz(). The model "automatic" is on the bonded layer of a block, if there is
    one, and on a half-space otherwise.

    Examples
    --------
    >>> model_named("independent")
    Independent()
    """
    if name not in MODELS:
        words = f"is unknown{suggestion(name, MODELS)}"
        raise InvalidInput(words, key="model", value=f'"{printable(name, 60)}"')
    from metafem.models.model import PARABOLOID, with_contact

    model = MODELS[name]()
    if name == AUTOMATIC and block is not None:
        model = mf.Automatic(AUTOMATIC_TOLERANCE, mf.BondedLayer())
    return with_contact(model, contact or PARABOLOID)


def suggestion(name: str, known: Iterable[str]) -> str:
    """Return the end of an error text: the known name that is nearest to `name`, and all known names."""
    near = get_close_matches(name, names := [*known], 1)
    meant = f"; did you mean {near[0]}?" if near else ""
    return f"{meant} (known: {', '.join(names)})"


def demo_text(name: str) -> str:
    """Return the text of a demonstration's specification: operating-points, linear or bilinear."""
    if name not in DEMOS:
        raise InvalidInput(f'demo "{printable(name, 60)}" is unknown{suggestion(name, DEMOS)}')
    return files(__name__).joinpath("demo_files", f"{name}.toml").read_text(encoding="utf-8")
