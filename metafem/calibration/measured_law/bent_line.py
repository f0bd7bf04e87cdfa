"""Fit of two straight lines that meet at a load to points with errors on both axes.

The line is ``y = a + m1 (x - c)`` below the crossover c, and ``y = a + m2 (x - c)`` above it. The chi-square
of a point is its squared distance from the bent line in standard deviations. This is the minimum over the
true load xi of ``(x - xi)^2 / sx^2 + (y - f(xi))^2 / sy^2``. The minimum is on one of the lines or at the
point where they meet. The chi-square is continuous in all parameters. All functions take the points x, y, sx,
sy of b laws at once, (4, b, n), sorted by x. Lines have the parameters c, a, m1, m2, (b, 4).
"""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray

# Indices of the parameters c, a, m1, m2 of a bent line.
KINK, LEVEL, LEFT, RIGHT = range(4)

# Largest number of steps of a descent. The descent ends if a step decreases chi-square by less than SETTLED,
# which is small compared with the growth of chi-square at the ends of intervals, about 1.
MOST_STEPS, SETTLED = 40, 1e-5

# Levenberg–Marquardt damping: initial value, and factors after a step that reduces or increases chi-square.
DAMPING, EASED, TIGHTENED = 1e-3, 0.2, 10.0

# Relative regularisation of the normal equations, because points with equal loads do not determine a slope.
REGULAR = 1e-9


# Bent lines (b, 4) and their chi-squares (b,).
Lines = tuple[FloatArray, FloatArray]


def deviations(points: FloatArray, p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the deviations along y and x in standard deviations, (b, n), and their derivatives (b, n, 4).

    The third value has the derivatives of the deviation along y. The deviation along x is 0, unless the true
    load is the crossover. In this case its only derivative, with respect to c, is ``-1 / sx``.
    """
    c, a, left, right = (p[:, i : i + 1] for i in range(4))
    x, y, sx, sy = points
    dx, dy, vx, vy = x - c, y - a, sx**2, sy**2
    found = []
    for m, side in ((left, -1.0), (right, 1.0)):
        spread = vy + m**2 * vx
        r = dy - m * dx
        # points whose nearest true load is beyond the crossover do not belong to this line
        there = side * (dx * spread + m * vx * r) >= 0.0
        found.append((r, spread, np.where(there, r**2 / spread, np.inf)))
    (r1, v1, d1), (r2, v2, d2) = found
    at_kink = dx**2 / vx + dy**2 / vy
    first = (d1 <= d2) & (d1 <= at_kink)
    kink = ~first & (at_kink < d2)
    m = np.where(first, left, right)
    r, v = np.where(first, r1, r2), np.where(first, v1, v2)
    m, r, v = np.where(kink, 0.0, m), np.where(kink, dy, r), np.where(kink, vy, v)
    root = np.sqrt(v)
    by_slope = np.where(kink, 0.0, -(dx + r * m * vx / v) / root)
    slopes = np.stack(
        [m / root, -1.0 / root, np.where(first, by_slope, 0.0), np.where(first, 0.0, by_slope)], axis=-1
    )
    return r / root, np.where(kink, dx / sx, 0.0), slopes


def chi_square(points: FloatArray, p: FloatArray) -> FloatArray:
    """Return the chi-square of each law about its bent line (b, 4), (b,)."""
    along_y, along_x, _ = deviations(points, p)
    found: FloatArray = (along_y**2 + along_x**2).sum(axis=1)
    return found


def descended(points: FloatArray, start: FloatArray, free: tuple[int, ...]) -> Lines:
    """Return lines and chi-squares of Levenberg–Marquardt fits of the free parameters from a start (b, 4)."""
    p, index = start.copy(), list(free)
    along_y, along_x, slopes = deviations(points, p)
    best = (along_y**2 + along_x**2).sum(axis=1)
    active, damping = np.arange(len(p)), np.full(len(p), DAMPING)
    for _ in range(MOST_STEPS):
        jacobian = slopes[:, :, index]
        normal = np.einsum("bni,bnj->bij", jacobian, jacobian)
        gradient = np.einsum("bni,bn->bi", jacobian, along_y)
        if KINK in free:
            sx, at = points[2, active], index.index(KINK)
            gradient[:, at] -= (along_x / sx).sum(axis=1)
            normal[:, at, at] += ((along_x != 0.0) / sx**2).sum(axis=1)
        diagonal = np.einsum("bii->bi", normal)
        scale = np.sqrt(diagonal + REGULAR * diagonal.max(axis=1, keepdims=True))
        scaled = normal / (scale[:, :, None] * scale[:, None, :])
        scaled += (damping[active, None, None] + REGULAR) * np.eye(len(index))
        step = -np.linalg.solve(scaled, (gradient / scale)[:, :, None])[:, :, 0] / scale
        trial = p[active]
        trial[:, index] += step
        new_y, new_x, new_slopes = deviations(points[:, active], trial)
        value = (new_y**2 + new_x**2).sum(axis=1)
        gain = best[active] - value
        better = gain > 0.0
        p[active[better]], best[active[better]] = trial[better], value[better]
        damping[active] *= np.where(better, EASED, TIGHTENED)
        pick = better[:, None]
        along_y, along_x = np.where(pick, new_y, along_y), np.where(pick, new_x, along_x)
        slopes = np.where(pick[:, :, None], new_slopes, slopes)
        # a step that does not reduce chi-square is repeated with more damping, until the damping is 1
        going = np.where(better, gain > SETTLED, damping[active] < 1.0)
        if not going.any():
            break
        active, along_y, along_x, slopes = active[going], along_y[going], along_x[going], slopes[going]
    return p, best


def fitted(points: FloatArray, kink: FloatArray, left: float | FloatArray | None = None,
           right: float | FloatArray | None = None) -> Lines:  # fmt: skip
    """Return the best line of each law for fixed crossovers (b,), and optionally one fixed slope."""
    (x, y, sx, sy), b = points, len(kink)
    dx = x - kink[:, None]
    columns = np.stack([np.ones_like(dx), np.minimum(dx, 0.0), np.maximum(dx, 0.0)], axis=-1)
    # initial guess: linear least squares; errors of x are converted with the slope of a line through all
    # points
    centred = x - x.mean(axis=1, keepdims=True)
    overall = (centred * y).sum(axis=1, keepdims=True) / (centred**2).sum(axis=1, keepdims=True)
    root = 1.0 / np.sqrt(sy**2 + (overall * sx) ** 2)
    p = np.zeros((b, 4))
    p[:, KINK] = kink
    free = [LEVEL]
    for index, value in ((LEFT, left), (RIGHT, right)):
        if value is None:
            free.append(index)
        else:
            p[:, index] = value
            y = y - p[:, index, None] * columns[:, :, index - LEVEL]
    weighted = root[:, :, None] * columns[:, :, [index - LEVEL for index in free]]
    normal = np.einsum("bni,bnj->bij", weighted, weighted)
    normal += REGULAR * np.einsum("bii->b", normal)[:, None, None] * np.eye(len(free))
    right_side = np.einsum("bni,bn->bi", weighted, root * y)
    p[:, free] = np.linalg.solve(normal, right_side[:, :, None])[:, :, 0]
    return descended(points, p, tuple(free))


def kink_grid(x: FloatArray, count: int) -> FloatArray:
    """Return crossovers between the third and the last but two loads of each law, (b, count)."""
    return x[:, 2:3] + (x[:, -3:-2] - x[:, 2:3]) * np.linspace(0.0, 1.0, count)


def least(points: FloatArray, count: int, left: float | FloatArray | None = None,
          right: float | FloatArray | None = None) -> Lines:  # fmt: skip
    """Return the best line of each law, with its crossover between the third and the last but two loads."""
    b = points.shape[1]
    grid = kink_grid(points[0], count)
    rows = np.repeat(np.arange(b), count)
    spread = [None if slope is None else np.broadcast_to(slope, b)[rows] for slope in (left, right)]
    tried, values = fitted(points[:, rows], grid.ravel(), *spread)
    place = values.reshape(b, count).argmin(axis=1) + count * np.arange(b)
    p, value = tried[place], values[place]
    free = (KINK, LEVEL, *([LEFT] if left is None else []), *([RIGHT] if right is None else []))
    polished, least_value = descended(points, p, free)
    inside = (polished[:, KINK] >= grid[:, 0]) & (polished[:, KINK] <= grid[:, -1])
    better = inside & (least_value < value)
    return np.where(better[:, None], polished, p), np.where(better, least_value, value)
