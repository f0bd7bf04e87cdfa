"""Leading error of order 1, which replaces the neighbours of a Hertz contact by point loads."""

from __future__ import annotations

import numpy as np

from validation.methods.independent import FloatArray


def area_error(contact_radius: FloatArray, distance: FloatArray) -> float:
    """Return the relative error of A0 at a given load for contacts at mutual distances (n, n) [mm].

    Point loads P_j = 4/3 E* a_j³/R bend the surface beneath contact i: the relative curvature grows by
    c_i = R sum_j P_j/(2 pi E* r_ij³) = 2/(3 pi) sum_j (a_j/r_ij)³, and Hertz's area at the same load shrinks
    by 2/3 c_i. Order 1 leaves this out. The size of the sources and the slope of their field change loads
    only, which moves A0 at second order.
    """
    apart = np.where(distance > 0.0, distance, np.inf)
    bent = 2.0 / (3.0 * np.pi) * ((contact_radius / apart) ** 3).sum(axis=1)
    area = contact_radius**2
    return float(2.0 / 3.0 * (bent * area).sum() / area.sum())
