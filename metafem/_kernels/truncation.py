"""Sum over pairs of contacts, from which the error of order 3 is estimated."""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.compiled import compiled

# Smallest weight of a pair, divided by the area of the source j. It matters for a small contact i: the error
# in the displacement by contact j changes the area of i by a fraction of the area of j. For paraboloids the
# change is .014 A_j R_i/R_j (a_j/r)^5, from the first term of Hertz's displacement that order 3 omits. In a
# thousand random scenes A0 changed by up to .037 times the sum of A_j R_i/R_j (a_j/r)^5. SMALL times
# `truncation.PAIRS` is .05.
SMALL = 0.2


@compiled
def pair_sum(position, response, source, area):
    """Return the sum of w_ij (a_j/r)^5 r_i/s_j divided by the contact area; infinite if contacts overlap.

    The weight is ``w_ij = max(A_i, SMALL A_j)``; its second part is the effect on a small contact.
    position: (n, 2) [mm]. response, source: radii r and s (n,) [mm] of two paraboloids equivalent to each
    contact; the first has the same change of area by a displacement, the second the same load. area: (n,)
    [mm^2], 0 if open.
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
                first, second = a * a / square, b * b / square
                at_i, at_j = response[i] / source[j], response[j] / source[i]
                weighted += max(area[i], SMALL * area[j]) * second * second * math.sqrt(second) * at_i
                weighted += max(area[j], SMALL * area[i]) * first * first * math.sqrt(first) * at_j
    return weighted / total if total > 0.0 else 0.0
