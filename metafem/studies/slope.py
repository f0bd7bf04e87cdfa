"""The slope of a friction law over a range of loads."""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True, eq=False)
class Slope:
    """The slope of the straight line fitted to A0 at equally spaced rescaled loads, (k,) [mm^2]."""

    load: FloatArray

    @classmethod
    def of(cls, surface: Surface, load_range: Any, model: Model) -> Slope:
        """Return the slope of a surface's law over a range of rescaled loads [mm^2].

        Default range: 25 to 100 % of the load at which the plane reaches the lowest summit, for independent
        asperities with the model's contact law. Raise InvalidInput if the range does not increase, or if no
        range is given and all summits have the same height.
        """
        if load_range is not None:
            return cls(np.linspace(*check.interval("load_range", load_range), LOADS))
        depth = float(np.ptp(surface.height))
        refuse_if(depth == 0.0, "must be given: all summits have one height", key="load_range")
        independent = Independent(contact=contact_of(model))
        foot = float(independent.curve(surface, approach=np.array([depth])).load[0])
        return cls(np.linspace(LOWEST * foot, HIGHEST * foot, LOADS))

    def fitted(self, area: FloatArray) -> FloatArray:
        """Return the slopes (...) [-] of areas (..., k) [mm^2] at the loads, by least squares."""
        off = self.load - self.load.mean()
        # no matrix product: its last bits would depend on the number of threads
        return np.asarray(np.einsum("...k,k->...", area, off / (off @ off)))

    @property
    def load_range(self) -> list[float]:
        """First and last load [mm^2]."""
        return [float(self.load[0]), float(self.load[-1])]

    @property
    def note(self) -> Note:
        """The range of loads in words; the source paper's Figs. S2 and S3 do not state theirs."""
        low, high = self.load_range
        words = f"the slope is fitted over P/E* = {low:.4g} to {high:.4g} mm^2"
        return information(f"{words}; the source paper does not print the range of its figures")
