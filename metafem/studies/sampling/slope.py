"""The slope of a friction law over a range of loads, as a linear function of its areas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.inversion.refinement import REACHED
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

# Allowed relative standard deviation of the slope: the misfit up to which a design counts as reached.
ALLOWED = REACHED


@dataclass(frozen=True, eq=False)
class Slope:
    """The slope of the straight line fitted to A0 over equally spaced loads, ``weight . A0``.

    Attributes
    ----------
    load : ndarray, (k,)
        Rescaled loads P/E* [mm^2].
    weight : ndarray, (k,)
        Weights of the areas, ``(P - mean P) / sum (P - mean P)^2`` [1/mm^2].
    """

    load: FloatArray
    weight: FloatArray

    @property
    def load_range(self) -> tuple[float, float]:
        """First and last load [mm^2]."""
        return float(self.load[0]), float(self.load[-1])

    @staticmethod
    def of(surface: Surface, load_range: Any = None, model: Model | None = None) -> Slope:
        """Return the slope of a surface's law over a range of rescaled loads [mm^2].

        Default range: 25 to 100 % of the load at which the plane reaches the lowest summit, for independent
        asperities with the model's contact law. Raise InvalidInput if the range is not increasing, or if no
        range is given and all summits have the same height.
        """
        if load_range is None:
            depth = float(np.ptp(surface.height))
            refuse_if(depth == 0.0, "must be given: all summits have one height", key="load_range")
            independent = Independent() if model is None else Independent(contact=contact_of(model))
            foot = float(independent.curve(surface, approach=np.array([depth])).load[0])
            low, high = LOWEST * foot, HIGHEST * foot
        else:
            low, high = check.interval("load_range", load_range)
        load = np.linspace(low, high, LOADS)
        deviation = load - load.mean()
        return Slope(load, deviation / (deviation @ deviation))

    @staticmethod
    def if_any(surface: Surface, load_range: Any, model: Model) -> tuple[Slope | None, list[Note]]:
        """Return the slope, or None and a note if no range is given and all summits have the same height."""
        if load_range is None and np.ptp(surface.height) == 0.0:
            words = "no slope: all summits have one height, and no load_range is given"
            return None, [information(words)]
        return Slope.of(surface, load_range, model), []

    @property
    def note(self) -> Note:
        """The range of loads in words."""
        low, high = self.load_range
        return information(f"the slope is fitted over P/E* = {low:.4g} to {high:.4g} mm^2")
