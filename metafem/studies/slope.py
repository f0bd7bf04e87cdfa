"""The slope of a friction law over a range of loads."""

from __future__ import annotations

from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.notes import Note, information
from metafem.surface import Surface

# Number of loads of a fit. With 20 loads, the slopes of the source paper's Fig. 4 differ by 0.1 %, and their
# scatter by 3 %, from the values for infinitely many loads.
LOADS = 20

# Default range, as fractions of the load at which the plane reaches the lowest summit. The source paper does
# not state its range; this range reproduces the slopes and scatters of its Fig. S3.
LOWEST, HIGHEST = 0.25, 1.0


def slope_loads(surface: Surface, load_range: Any, model: Model) -> FloatArray:
    """Return the equally spaced rescaled loads (k,) [mm^2] at which a slope is fitted.

    Default range: 25 to 100 % of the load at which the plane reaches the lowest summit, for independent
    asperities with the model's contact law. Raise InvalidInput if the range does not increase, or if no
    range is given and all summits have the same height.
    """
    if load_range is not None:
        return np.linspace(*check.interval("load_range", load_range), LOADS)
    depth = float(np.ptp(surface.height))
    refuse_if(depth == 0.0, "must be given: all summits have one height", key="load_range")
    independent = Independent(contact=contact_of(model))
    foot = float(independent.curve(surface, approach=np.array([depth])).load[0])
    return np.linspace(LOWEST * foot, HIGHEST * foot, LOADS)


def slope(load: FloatArray, area: FloatArray) -> FloatArray:
    """Return the least-squares slopes (...) [-] of areas (..., k) [mm^2] at rescaled loads (k,) [mm^2]."""
    off = load - load.mean()
    # no matrix product: its last bits would depend on the number of threads
    return np.asarray(np.einsum("...k,k->...", area, off / (off @ off)))


def range_note(load: FloatArray) -> Note:
    """Return a note on the range of loads; the source paper does not state that of its Figs. S2 and S3."""
    words = f"the slope is fitted over P/E* = {load[0]:.4g} to {load[-1]:.4g} mm^2"
    return information(f"{words}; the source paper does not print the range of its figures")
