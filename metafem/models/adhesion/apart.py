"""Loading curves of adhesive contacts that do not interact, for all loads at once.

The contacts close at ``x = gap``, where the load jumps down; between, it is an increasing and convex function
of the approach, so that Newton's method converges from above. It begins with tables of the contacts, and ends
with the equations themselves.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from metafem._kernels import adhesion as kernel
from metafem._kernels.newton import TOLERANCE
from metafem._validate import FloatArray
from metafem.contact import JKR
from metafem.models.adhesion.contacts import Scene, States

# Number of contacts in a table, whose linear interpolation has errors of the square of its inverse, and
# largest number of steps of Newton's method: far above the load, a step with tables divides x by three.
TABULATED, MOST_STEPS = 400, 60

# Step of Newton's method over the approach, after which the next one would be near rounding.
NEAR = 1e-6


def loading_pieces(scene: Scene) -> tuple[np.ndarray, FloatArray, FloatArray, int]:
    """Return the contacts (k, n) of the pieces of the loading path, whose gaps close one after the other.

    Also return the approaches (k,) [mm] at their ends, those up to which the law describes their contacts,
    and the index of the first piece in which the law ends.
    """
    start = np.unique(scene.gap)
    closed, ends = scene.gap <= start[:, None], np.append(start[1:], np.inf)
    most = np.where(closed, scene.gap + scene.law.largest_indentation(scene.radius), np.inf).min(axis=1)
    return closed, ends, most, int((ends >= most).argmax())


def loaded_apart(scene: Scene, load: FloatArray) -> States | None:
    """Return the states at increasing loads (k,), or None if some are beyond the range of the law."""
    gap, (closed, ends, most, last) = scene.gap, loading_pieces(scene)
    sizes, which = np.unique(scene.radius, return_inverse=True)
    table = np.array([_table(scene.law, size.tobytes(), sizes.dtype) for size in sizes])
    carried = kernel.loads(table, which, gap, closed[:last], ends[:last])
    piece = np.searchsorted(np.maximum.accumulate(carried), load)
    now, high = closed[piece], np.minimum(ends, most)[piece]
    # the tallest at least carries the load and what the others pull, the most after their jumps into contact
    pulled, (depth, _, alone, _) = -table[which, 2, 0].sum(), table[which[gap.argmin()]]
    high = np.minimum(high, gap.min() + np.interp(load + pulled, alone, depth, right=np.inf))
    x = high.copy()
    a = kernel.approached(table, which, gap, now, load, x, 1.0 / TABULATED**2, MOST_STEPS)
    for _ in range(MOST_STEPS):
        a = np.maximum(a, scene.entry_radius)
        at = scene.fields(a, now)
        missing = x[:, None] - gap - (at.depth - at.deficit)
        rate = at.rise / at.slope
        step = (load - (at.load + rate * missing).sum(axis=1)) / rate.sum(axis=1)
        a, x = a + (missing + step[:, None]) / at.slope, x + step
        if (np.abs(step) <= NEAR * x).all():
            found = States(scene, now, np.where(now, a, 0.0), x, scene.at_load(load))
            if (found.residual <= TOLERANCE).all():
                return found if (x <= high * (1.0 + TOLERANCE)).all() else None
    return None


@lru_cache(maxsize=64)
def _table(law: JKR, radius: bytes, kind: Any) -> tuple[FloatArray, ...]:
    """Return increasing indentations [mm] of one contact, its radii [mm], loads [mm^2] and dP/dd [mm]."""
    scene = Scene(law, np.frombuffer(radius, kind), np.zeros(1))
    a = np.geomspace(scene.entry_radius[0], scene.largest_radius[0], TABULATED)
    found = scene.fields(a[:, None], np.ones((TABULATED, 1), dtype=bool))
    depth, load = found.depth - found.deficit, found.load
    return tuple(each.ravel() for each in (depth, a, load, found.rise / found.slope))
