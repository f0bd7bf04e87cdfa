"""The band that contains the law of every surface within the limits."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from metafem.contact import Contact
from metafem.explorer.certainty.band import Band
from metafem.files import Specification
from metafem.inversion import Limits, feasible_region
from metafem.inversion.feasibility import bounds_of
from metafem.inversion.tools.kit import Given, chosen
from metafem.models.model import contact_of
from metafem.surface import Surface

# Number of loads of the band, and the smallest load as a fraction of the largest. The loads are spaced evenly
# in the logarithm: neighbours differ by 8 %, and a straight line between them is within 0.1 % of a power law
# with exponent 2/3.
LOADS, LEAST = 120, 1e-4

# Number of bands that are stored: those of the open pages, which are few.
BANDS = 4


def reach_of(specification: Specification) -> Band | None:
    """Return rescaled load, and lowest and highest rescaled friction (k,) [mm^2]; None without a bound.

    The bounds are proven for independent asperities. The same object is returned for the same limits, sites,
    tools and contact law.
    """
    template = specification.template
    count = template.count - sum(height is None for height in specification.pinned.values())
    contact: Any = contact_of(specification.model)  # a frozen value, which can be hashed
    return _band(template.only(slice(count)), specification.limits, specification.tools, contact)


@lru_cache(BANDS)
def _band(template: Surface, limits: Limits, tools: Given | None, contact: Contact) -> Band | None:
    largest = bounds_of(*chosen(tools, template), contact, 0.0).largest_load(limits)
    if not 0.0 < largest < np.inf:
        return None
    load = largest * np.geomspace(LEAST, 1.0, LOADS)
    load[-1] = largest
    low, high = feasible_region(template, load, limits, tools, contact)
    return (load, low, high) if np.isfinite(high[:-1]).all() else None
