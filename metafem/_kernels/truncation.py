"""Sum over pairs of contacts by which the error of order 3 is estimated."""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.compiled import compiled


@compiled
def pair_sum(position, radius, area):
    """Return the mean of sum_j (a_j/r)^5 R_i/R_j over the contact area, infinite where contacts overlap.

    position: (n, 2) [mm]; radius: (n,) [mm]; area: (n,) of each contact [mm^2], 0 where it is open.
    """
    contact_radius = np.sqrt(area / math.pi)
    total = weighted = 0.0
    for i in range(area.size):
        total += area[i]
        a = contact_radius[i]
        for j in range(i):
            b = contact_radius[j]
            if a > 0.0 and b > 0.0:
                dx, dy = position[i, 0] - position[j, 0], position[i, 1] - position[j, 1]
                square = dx * dx + dy * dy
                if (a + b) * (a + b) >= square:
                    return math.inf
                first, second, curved = a * a / square, b * b / square, radius[i] / radius[j]
                weighted += area[i] * second * second * math.sqrt(second) * curved
                weighted += area[j] * first * first * math.sqrt(first) / curved
    return weighted / total if total > 0.0 else 0.0
