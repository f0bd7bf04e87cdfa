"""Standard deviations of contact areas measured in images.

Lengths are in pixels, and grey levels are divided by the contrast. A contact has the perimeter L and the
radius r. n is the noise of a pixel. The edge is a step blurred by a Gaussian of standard deviation s. The
image is smoothed again by a Gaussian of standard deviation w before the contour is found. The edge then has
the variance s_t² = s² + w² and the slope 1/(sqrt(2 pi) s_t) at the half level.

Noise. The smoothed noise over the slope is the displacement of the contour. The error of the area is the
integral of this displacement along the contour. Its variance is 2 pi s_t² L n²/(2 sqrt(pi) w), which has the
minimum 2 sqrt(pi) s L n² at w = s. This minimum is the Cramér-Rao bound for a straight edge of length L. The
Fisher information on the position of the edge is L/n² times the integral of the squared slope of the edge,
which gives L/(2 sqrt(pi) s n²), and the area changes by L times the displacement.

Curvature. Smoothing by s moves a contour of curvature kappa at the half level by s² kappa/2 towards its
centre of curvature. The curvature of a closed contour integrates to 2 pi. Therefore the area of any shape
shrinks by pi s², and grows by pi s² for each hole. For a circle, the half level follows from the median of
the noncentral chi-square distribution with two degrees of freedom; the next term is pi s² s²/(6 r²).

Level. An error d of the half level displaces the whole contour by d sqrt(2 pi) s_t.
"""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray

# Polygons from marching squares lie inside smooth contours, because the interpolation is linear and the sides
# are chords. For any shape and blur, the lost area is pi times INTERPOLATION [pixels²]. The variance of an
# edge that is measured from its quarter levels is too large by EDGE_INTERPOLATION [pixels²] and, for a
# circle, by the relative amount EDGE_CURVATURE s_t²/r². The numbers were determined with circles of radius 15
# to 120 at random positions and s_t of 1.4 to 3.5.
INTERPOLATION, EDGE_INTERPOLATION, EDGE_CURVATURE = 0.21, 0.13, 0.5


def enclosed(area: FloatArray, holes: FloatArray | float, total: float) -> FloatArray:
    """Return the contact areas (n,) from the `area` within the contours at the half level; `total` is s_t."""
    variance = total**2 + INTERPOLATION
    return area + math.pi * variance * (1.0 - holes) + (math.pi * total**2) ** 2 / (6.0 * area)


def of_contour(
    length: FloatArray, noise: float, smoothing: float, total: float, level: float, blur: float
) -> FloatArray:
    """Return the standard deviations of areas (n,) from the noise and the errors of the level and of s_t."""
    from_noise = 2.0 * math.pi * total**2 * length * noise**2 / (2.0 * math.sqrt(math.pi) * smoothing)
    from_level = math.sqrt(2.0 * math.pi) * total * length * level
    from_blur = 2.0 * math.pi * total * blur
    return np.sqrt(from_noise + from_level**2 + from_blur**2)


def quantisation(noise: float, step: float) -> float:
    """Return the quantisation error of the difference between two mean grey levels.

    Without noise, a grey level is wrong by up to half a step, with the variance step²/12. Noise n distributes
    a level over several steps. By the Fourier series of a sawtooth, this reduces the error of the mean level
    by the factor exp(-2 pi² n²/step²).
    """
    if not step:
        return 0.0
    return math.sqrt(2.0 / 12.0) * step * math.exp(-2.0 * (math.pi * noise / step) ** 2)
