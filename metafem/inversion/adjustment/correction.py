"""Smallest change of the heights of a surface that brings its law into a band.

For heights h with the law A(h) (k,) and the exact sensitivities ``G = dA0/dh``, each step solves

    min |h + s - h0|^2   subject to   l <= A + G s <= u,   |s_i| <= D,   foot <= h + s <= top,

a least-distance problem ``min |x|^2, C x >= b`` in x = h + s - h0. Its solution follows from non-negative
least squares: with the residual r = E v - e of ``min |E v - e|, v >= 0``, where ``E = [C'; b']`` and
e = (0, ..., 0, 1), it is ``x = -r[:n]/r[n]``; the problem has no solution if r = 0. Lawson and Hanson,
Solving Least Squares Problems (1995), doi:10.1137/1.9781611971217, chapter 23.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.errors import Infeasible
from metafem.inversion.adjustment.band_margin import area_of
from metafem.inversion.limits import Limits
from metafem.inversion.targets.band import Band
from metafem.models import Independent, Model
from metafem.progress import doing, each
from metafem.surface import Surface

# Maximum number of steps, and the first and smallest bound of a step relative to the mean radius.
STEPS, FIRST, LEAST = 100, 0.05, 1e-9

# The aim of each step is inside the band by this fraction of its width, so that rounding and curvature of the
# law do not leave it outside.
INSIDE = 1e-4

# A step that changes the distance from the given heights by less than this fraction ends the search.
GAIN = 1e-6

# Number of halvings of a violation that the linearised law cannot remove at once.
HALVINGS = 6


@dataclass(frozen=True, eq=False)
class Correction:
    """Heights whose law is within a band, near the heights of a given surface.

    Attributes
    ----------
    surface : Surface
        The given surface with the new heights.
    change : ndarray, (n,)
        Change of each height [mm].
    area : ndarray, (k,)
        A0 at the loads of the band under the model [mm^2].

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (1, 2), radius=0.5, material=mf.Material(1.36))
    >>> found = mf.brought_into(surface, mf.Band([0.02], [0.13], [0.15]))
    >>> bool(0.13 < found.area[0] < 0.15)
    True
    """

    surface: Surface
    change: FloatArray
    area: FloatArray

    @property
    def largest_change(self) -> float:
        """Largest change of a height [mm]."""
        return float(np.abs(self.change).max())


@doing("changing the heights")
def brought_into(
    surface: Surface,
    band: Band,
    model: Model | None = None,
    limits: Limits | None = None,
    *,
    only_lower: bool = False,
) -> Correction:
    """Return the smallest change found of the heights of a surface that brings its law into a band.

    The sum of squares of the changes is minimised. The minimum is local.

    Parameters
    ----------
    surface : Surface
        Surface whose heights change, for example a measured part.
    band : Band
    model : Model, optional
        Model under which the law must be within the band; default: `Independent()`.
    limits : Limits, optional
        Range of the new heights; default: from 0 to the tallest height plus the mean radius. A height that
        is outside already must return into it. `height_step` and `pinned` are not used.
    only_lower : bool
        Whether heights may only decrease, because a workshop can only remove material. Default: False.

    Returns
    -------
    Correction

    Raises
    ------
    Infeasible
        If no such heights were found.
    InvalidInput
        For arguments of the wrong kind.

    Examples
    --------
    Of two asperities, lowering the lower one reduces the area.

    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([0.1, 0.09], (1, 2), radius=0.5, material=mf.Material(1.36))
    >>> found = brought_into(surface, mf.Band([0.02], [0.13], [0.15]), only_lower=True)
    >>> bool(np.all(found.change <= 0.0)), bool(found.area[0] <= 0.15)
    (True, True)
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    check.instance("band", band, Band, "a metafem.Band")
    check.instance("only_lower", only_lower, bool, "True or False")
    solver: Model = Independent() if model is None else model
    check.instance("model", solver, Model, "a model such as metafem.Independent()")
    check.instance("limits", limits, Limits | None, "metafem.Limits")
    start, radius = surface.height, float(surface.radius.mean())
    foot, top = (0.0, float(start.max()) + radius) if limits is None else (limits.foot, limits.top)
    # bounds of the change of each height
    least, most = np.minimum(foot - start, 0.0), np.maximum(top - start, 0.0)
    least = np.where(start > top, foot - start, least)
    if limits is not None:
        least, most = foot - start, top - start
    if only_lower:
        most = np.minimum(most, 0.0)
    if (least > most).any():
        raise Infeasible("some heights are below the lowest allowed height and may only be lowered")
    load, law = band.rescaled_load, band.curve()
    margin = INSIDE * (band.highest - band.lowest)
    low, high = band.lowest + margin, band.highest - margin

    def violation(area: FloatArray) -> float:
        return float(np.maximum(np.maximum(low - area, area - high), 0.0).max())

    def searched(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the change (n,) [mm] found from a first change, and the areas (k,) [mm^2]."""
        area = solver.curve(surface.replaced(height=start + x), load).checked().area
        size, gradient = FIRST * radius, None
        for _ in each("step", range(STEPS), at_most=True):
            if size < LEAST * radius:
                break
            if gradient is None:
                gradient = solver.gradient_model.sensitivity(surface, load, start + x).gradient
            ends = np.maximum(least, x - size), np.minimum(most, x + size)
            new = _step(x, area, gradient, (low, high), ends)
            if new is None:
                break
            new = np.clip(new, least, most)
            found = area_of(solver, surface, start + new, load)
            before, outside = float(x @ x), violation(area)
            after = np.inf if found is None else violation(found)
            closer = after < outside or (after == 0.0 and float(new @ new) < before * (1.0 - GAIN))
            # within the band, a shorter change counts even if it uses some of the margin of the aim
            if found is not None and law.misfit(area) == 0.0 and law.misfit(found) == 0.0:
                closer = float(new @ new) < before * (1.0 - GAIN)
            if found is not None and closer:
                x, area, gradient, size = new, found, None, 2.0 * size
            else:
                size *= 0.25
        return x, area

    # equal heights have no first-order sensitivity: the second search begins with heights that differ
    spread = np.linspace(-0.5, 0.5, len(start)) - 0.5 * only_lower
    for first in (np.zeros(len(start)), FIRST * radius * spread):
        x, area = searched(np.clip(first, least, most))
        if law.misfit(area) == 0.0:
            break
    outside = float(np.abs(law.difference(area)).max())
    if outside > 0.0:
        far = percent(outside, ".3g")
        words = f"no heights within the band were found: the nearest law found is outside by {far}"
        more = "; heights may only be lowered" if only_lower else ""
        raise Infeasible(f"{words}{more}", by_search=True)
    return Correction(surface.replaced(height=start + x), x, area)


def _step(
    x: FloatArray,
    area: FloatArray,
    gradient: FloatArray,
    band: tuple[FloatArray, FloatArray],
    ends: tuple[FloatArray, FloatArray],
) -> FloatArray | None:
    """Return the shortest change (n,) [mm] within the linearised band, or within a wider band if necessary.

    Of a band that no change within the ends reaches, the violation is allowed to be a part of the present
    one: 0, 1/2, 3/4, ...; None if even that has no solution.
    """
    low, high = band
    over, under = np.maximum(area - high, 0.0), np.maximum(low - area, 0.0)
    eye = np.eye(len(x))
    fixed = gradient @ x - area
    scale = 1.0 / np.maximum(np.abs(gradient).max(axis=1), 1e-300)
    for part in 1.0 - 0.5 ** np.arange(HALVINGS):
        rows = [scale[:, None] * gradient, -scale[:, None] * gradient, eye, -eye]
        right = [
            scale * (low - part * under + fixed),
            -scale * (high + part * over + fixed),
            ends[0],
            -ends[1],
        ]
        found = _least_distance(np.vstack(rows), np.concatenate(right))
        if found is not None:
            return found
    return None


def _least_distance(rows: FloatArray, right: FloatArray) -> FloatArray | None:
    """Return the x (n,) of least norm with ``rows @ x >= right``, or None if there is none."""
    size = float(np.abs(right).max()) or 1.0
    matrix, wanted = np.vstack([rows.T, right / size]), np.zeros(rows.shape[1] + 1)
    wanted[-1] = 1.0
    try:
        dual, norm = nnls(matrix, wanted, maxiter=30 * len(right))
    except RuntimeError:  # too many iterations
        return None
    rest = matrix @ dual - wanted
    if norm < 1e-9 or rest[-1] == 0.0:
        return None
    found = -size * rest[:-1] / rest[-1]
    # rows that have no gradient can make the constraints contradict each other
    return found if (rows @ found >= right - 1e-6 * size).all() else None
