"""Standard deviations of contact areas from images; lengths in pixels, grey levels over the contrast.

A contact has the perimeter L and the radius r. Each pixel has the noise n over the contrast, and the edge is
a step smoothed by a Gaussian of standard deviation s. The contour is found after another smoothing by w; its
edge has s_t² = s² + w², and the slope 1/(sqrt(2 pi) s_t) at the half level.

Noise. The contour is displaced by the smoothed noise over the slope. Its integral along a line, the error of
the area, has the variance 2 pi s_t² L n²/(2 sqrt(pi) w). It is smallest for w = s: 2 sqrt(pi) s L n². That is
the Cramér-Rao bound of the position of a straight edge: its Fisher information is L/n² times the integral of
the square of the edge's slope, L/(2 sqrt(pi) s n²), for an area of L times the displacement.

Curvature. Smoothing by s moves the half level by s² kappa/2 towards the centre of curvature. The curvature of
a closed contour integrates to 2 pi, so that the area shrinks by pi s² for any shape, and grows by pi s² for
each hole. For a circle, the half level is where the noncentral chi-square distribution of two degrees of
freedom has its median, and the next term is pi s² s²/(6 r²).

Level. An error d of the half level displaces the contour by d sqrt(2 pi) s_t everywhere.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtri

from metafem._validate import FloatArray

# Contours that connect points on the sides of cells of pixels lie inside smooth ones, because of linear
# interpolation along the sides and of their sagitta: the area lost is pi times this variance [pixels²], for
# any shape and blur. The variance of an edge from its quarter levels is larger by the second number, and for
# a circle by the relative amount s_t²/(2 r²). Measured on circles of radius 15 to 120 and random centre, with
# s_t of 1.4 to 3.5.
INTERPOLATION, EDGE_INTERPOLATION, EDGE_CURVATURE = 0.21, 0.13, 0.5

# Variance of the number of pixels whose centres lie in a disc with random centre, over its perimeter. By
# Poisson summation it is the sum of (r J1(2 pi r k)/k)² over the lattice of k without 0; with the mean 1/(pi
# z) of J1(z)² it is r/(2 pi²) times the sum of k^-3, which is 4 zeta(3/2) beta(3/2) = 9.0336.
COUNTED = 0.0728


def enclosed(area: FloatArray, holes: FloatArray | float, total: float) -> FloatArray:
    """Return the areas of contacts whose contours at the half level enclose `area`; `total` is s_t."""
    variance = total**2 + INTERPOLATION
    return area + math.pi * variance * (1.0 - holes) + (math.pi * total**2) ** 2 / (6.0 * area)


def of_contour(
    length: FloatArray, noise: float, smoothing: float, total: float, level: float, blur: float
) -> FloatArray:
    """Return the standard deviations of areas from noise, from the level's error and from that of s_t."""
    from_noise = 2.0 * math.pi * total**2 * length * noise**2 / (2.0 * math.sqrt(math.pi) * smoothing)
    from_level = math.sqrt(2.0 * math.pi) * total * length * level
    from_blur = 2.0 * math.pi * total * blur
    return np.sqrt(from_noise + from_level**2 + from_blur**2)


def quantisation(noise: float, step: float) -> float:
    """Return the error of the difference of two mean grey levels from steps of the grey levels.

    Without noise, a level is wrong by up to half a step, with the variance 1/12. Noise spreads a level over
    the steps: by the Fourier series of a sawtooth, the error of its mean is reduced by the factor exp(-2 pi²
    n²/step²).
    """
    if not step:
        return 0.0
    return math.sqrt(2.0 / 12.0) * step * math.exp(-2.0 * (math.pi * noise / step) ** 2)


def counting_bias(length: FloatArray, threshold: float, edge: float) -> FloatArray:
    """Return the bias of the number of pixels darker than a threshold, 0 to 1 from the ground to the dark.

    The pixels' own edge s is `edge`: the contour lies sqrt(2) s erfinv(1 - 2 threshold) outside the half
    level, whose area is too small by pi s².
    """
    displaced = edge * float(ndtri(1.0 - np.clip(threshold, 1e-6, 1.0 - 1e-6)))
    return length * displaced + math.pi * (displaced**2 - edge**2)


def of_counting(length: FloatArray, noise: float, threshold: float, edge: float) -> FloatArray:
    """Return the errors of counted areas: scatter and bias, added in quadrature.

    A pixel at the distance u from the contour is counted wrongly with a probability that follows from the
    noise and the slope of the edge; the variances add up to sqrt(2) s n L.
    """
    scatter = (math.sqrt(2.0) * edge * noise + COUNTED) * length
    return np.sqrt(scatter + counting_bias(length, threshold, edge) ** 2)
