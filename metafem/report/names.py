"""Texts for models, misfits and notes."""

from __future__ import annotations

import math
import warnings
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from metafem._values import percent
from metafem.contact import JKR, Contact, Hertz, JacksonGreen, KogutEtsion
from metafem.errors import MetafemWarning
from metafem.inversion import Design, plasticity_index
from metafem.inversion.result import misfit_text
from metafem.inversion.infeasible import ELASTIC_LIMIT, INDEX
from metafem.models import Model
from metafem.models.curve import ModelError
from metafem.models.model import contact_of
from metafem.notes import Level, Note

# One N/mm in mJ/m^2.
MJ_PER_M2 = 1e6


def in_python(value: Any) -> str:
    """Return a model as Python code, without default arguments; of a table, the code states only the size."""
    members = {field: getattr(value, field.name) for field in fields(value)} if is_dataclass(value) else {}
    if not members or any(isinstance(member, np.ndarray) or callable(member) for member in members.values()):
        return repr(value)
    given = []
    for field, member in members.items():
        default = field.default_factory() if callable(field.default_factory) else field.default
        if member != default:
            given.append(f"{field.name}={in_python(member)}")
    return f"{type(value).__name__}({', '.join(given)})"


def model_words(model: Model) -> str:
    """Return a model's name with its contact law in words, for texts and legends.

    Examples
    --------
    >>> from metafem import JKR, Independent
    >>> model_words(Independent(JKR(1.604e-5)))
    'independent, JKR, w = 16 mJ/m²'
    """
    law = contact_of(model)
    return model.name.replace(repr(law), law_words(law))


def law_words(law: Contact) -> str:
    """Return a contact law in words, or as Python code if it has no short name."""
    if isinstance(law, JKR):
        cap = "" if law.cap == Hertz() else f", {law_words(law.cap)}"
        return f"JKR, w = {MJ_PER_M2 * law.adhesion_energy:.3g} mJ/m²{cap}"
    if isinstance(law, KogutEtsion):
        return f"Kogut and Etsion, hardness {law.hardness:.3g} MPa"
    if isinstance(law, JacksonGreen):
        return f"Jackson and Green, yield strength {law.yield_strength:.3g} MPa"
    return repr(law)


def model_data(model: Model) -> dict[str, str]:
    """Return a model's name and its Python code, for JSON.

    Examples
    --------
    >>> from metafem import Independent
    >>> model_data(Independent())
    {'name': 'independent', 'python': 'Independent()'}
    """
    return {"name": model.name, "python": in_python(model)}


def error_words(error: ModelError) -> str:
    """Return the estimated error of a model in words.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (4, 4), radius=0.526, material=mf.Material(1.36))
    >>> error_words(mf.equilibrium(surface, mf.Interacting(1), load=0.2).model_error)
    'estimated error of A0(P): 0.067 %, by order 3 on the half-space'
    """
    if math.isnan(error):
        return f"error of A0(P): unknown, because {error.source}"
    return f"estimated error of A0(P): {percent(error)}, by {error.source}"


def error_data(error: ModelError) -> dict[str, Any]:
    """Return the estimated error of a model for JSON; its value is None if it is unknown."""
    return {"value": None if math.isnan(error) else float(error), "source": error.source}


def misfit_words(design: Design) -> tuple[str, str]:
    """Return what the misfit of a design means, and the value of the misfit.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> misfit_words(mf.design(mf.OperatingPoints([0.01], [0.1]), template))
    ('misfit: largest difference from the target', 'below 1e-9')
    """
    return f"misfit: {design.misfit_meaning}", misfit_text(design.misfit)


def all_notes(design: Design, hardness: float | None = None) -> tuple[Note, ...]:
    """Return the notes of a design and of its plasticity index, warnings first.

    Parameters
    ----------
    design : Design
    hardness : float, optional
        Hardness H of the softer material [MPa]; default: None, without the plasticity index.
    """
    found = [*design.notes]
    if hardness is not None:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", MetafemWarning)
            psi = plasticity_index(design.surface, hardness)
        remedies = ("hardness", "radius")
        found += [
            Note(str(warning.message), Level.WARNING, INDEX, psi, ELASTIC_LIMIT, remedies)
            for warning in caught
        ]
    return tuple(sorted(found, key=lambda note: not note.warns))
