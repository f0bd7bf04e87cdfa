"""Checked arguments of the predictions of quantities."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.models import Independent, Model
from metafem.models.model import checked_model
from metafem.surface import Surface


def given(surface: Surface, model: Model | None, load: ArrayLike) -> tuple[Model, FloatArray]:
    """Return the model, by default independent asperities, and the loads P/E* [mm^2] in increasing order."""
    check.instance("surface", surface, Surface, "a metafem.Surface")
    newtons = np.sort(check.array("load", load, shape=(None,)))
    check.refuse_entries("load", newtons, ~(newtons >= 0.0) | np.isinf(newtons), "must be at least 0 N")
    solver = checked_model(Independent() if model is None else model)
    return solver, np.asarray(newtons / surface.material.composite_modulus)
