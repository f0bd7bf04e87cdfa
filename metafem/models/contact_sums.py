"""Load equation of independent asperities of any contact law, in rescaled loads P/E* [mm^2]."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.errors import InvalidInput

# Doublings of the approach, and steps of Newton's method or of bisection; both are enough for any load.
MOST_DOUBLINGS = 200
MOST_STEPS = 200


class Contacts(NamedTuple):
    """Contacts at given indentations, all arrays of one shape."""

    load: FloatArray  # P/E* [mm^2]
    area: FloatArray  # [mm^2]
    stiffness: FloatArray  # derivative of the load by the indentation [mm]
    contact_radius: FloatArray  # [mm]


def contacts(law: Contact, indentation: FloatArray, radius: FloatArray) -> Contacts:
    """Return the undisturbed contacts at indentations [mm]; a negative one is an open contact."""
    a = law.contact_radius(indentation, radius)
    stiffness = law.stiffness(a, radius)
    # to first order in the rounding of a: near the equator of a sphere the load alone loses its digits
    missing = np.where(a > 0.0, indentation - law.indentation(a, radius), 0.0)
    return Contacts(law.load(a, radius) + stiffness * missing, law.area(a), stiffness, a)


def sums(law: Contact, gap: FloatArray, radius: FloatArray, approach: FloatArray) -> tuple[FloatArray, ...]:
    """Return load [mm^2], area [mm^2] and stiffness [mm] of a surface at approaches (k,) [mm]."""
    found = contacts(law, approach[:, None] - gap, radius)
    return found.load.sum(axis=1), found.area.sum(axis=1), found.stiffness.sum(axis=1)


def approach_at_load(law: Contact, gap: FloatArray, radius: FloatArray, load: FloatArray) -> FloatArray:
    """Return the approaches [mm] at loads (k,), by Newton's method inside a bracket, to rounding.

    gap, radius: (n,) [mm]. Raise InvalidInput for a load that the law does not reach.
    """
    approach = np.zeros(len(load))
    active = np.flatnonzero(load > 0.0)
    low, high = np.zeros(len(load)), np.zeros(len(load))
    # of the order of the indentation of the tallest contact alone
    high[active] = np.cbrt(load[active] ** 2 / radius[gap.argmin()])
    most = float((gap + law.largest_indentation(radius)).min())
    below = active
    for _ in range(MOST_DOUBLINGS):
        high[below] = np.minimum(high[below], most)
        short = sums(law, gap, radius, high[below])[0] < load[below]
        below = below[short]
        if not below.size:
            break
        low[below] = high[below]
        if low[below].max() >= most:
            raise InvalidInput(
                f"the load {load[below].max():.4g} mm^2 needs an approach beyond {most:.4g} mm, up to which "
                f"{law!r} describes all contacts; use lighter loads or a law with a larger range"
            )
        high[below] *= 2.0
    approach[active] = high[active]
    for _ in range(MOST_STEPS):
        x = approach[active]
        carried, _, slope = sums(law, gap, radius, x)
        excess = carried - load[active]
        high[active] = np.where(excess >= 0.0, x, high[active])
        low[active] = np.where(excess <= 0.0, x, low[active])
        with np.errstate(divide="ignore", invalid="ignore"):
            new = x - excess / slope
        settled = np.abs(new - x) <= np.finfo(np.float64).eps * x
        inside = (new > low[active]) & (new < high[active])
        new = np.where(inside | settled, new, 0.5 * (low[active] + high[active]))
        approach[active] = new
        active = active[~settled]
        if not active.size:
            break
    return approach
