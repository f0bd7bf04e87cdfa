"""The band that contains the law of every surface within the limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.files import Specification
from metafem.inversion import feasible_region
from metafem.inversion.feasibility import bounds_of
from metafem.inversion.tools.kit import chosen
from metafem.models.model import contact_of

# Number of loads of the band, and the smallest load as a fraction of the largest. The loads are spaced evenly
# in the logarithm: neighbours differ by 8 %, and a straight line between them is within 0.1 % of a power law
# with exponent 2/3.
LOADS, LEAST = 120, 1e-4

Band = tuple[FloatArray, FloatArray, FloatArray]


class Reach:
    """The band of the last specification, which is computed again only if one of its inputs has changed."""

    def __init__(self) -> None:
        self.key: Any = None
        self.band: Band | None = None

    def of(self, specification: Specification) -> Band | None:
        """Return rescaled load, and lowest and highest rescaled friction (k,) [mm^2]; None without a bound.

        The bounds are proven for independent asperities.
        """
        template = specification.template
        count = template.count - sum(height is None for height in specification.pinned.values())
        key = (
            *(count, float(template.radius[0]), template.material, template.friction, specification.limits),
            *(specification.tools, contact_of(specification.model)),
        )
        if key != self.key:
            self.key, self.band = key, band_of(specification, count)
        return self.band


def band_of(specification: Specification, count: int) -> Band | None:
    """Return rescaled load, lowest and highest friction (k,) [mm^2] of `count` asperities, or None."""
    template = specification.template
    if np.ndim(template.friction_weights):  # the bounds are those of one friction
        return None
    template = template.only(slice(count))
    limits, tools, contact = specification.limits, specification.tools, contact_of(specification.model)
    largest = bounds_of(*chosen(tools, template), contact, 0.0).largest_load(limits)
    if not 0.0 < largest < np.inf:
        return None
    load = largest * np.geomspace(LEAST, 1.0, LOADS)
    load[-1] = largest
    low, high = feasible_region(template, load, limits, tools, contact)
    if not np.isfinite(high[:-1]).all():
        return None
    return load, low, high
