"""Mirror image of the mould, for its mesh, its drawing and its table."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray


def mirrored(points: FloatArray) -> FloatArray:
    """Return points of the part (n, 2) or (n, 3) as seen from the open face of the mould: x -> -x [mm].

    The part lies face down on the mould, as on a page that is turned over.
    """
    result = np.array(points)
    result[:, 0] = 0.0 - result[:, 0]  # -x is -0.0 on the axis
    return result
