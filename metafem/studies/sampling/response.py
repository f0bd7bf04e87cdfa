"""The area of one surface as a function of the load and of a common factor of its radii."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models import Independent, Model
from metafem.surface import Surface

# Loads at which the difference from independent asperities is computed; under a layer the error of A0 is
# then below 0.5 % at the entry of a contact, and 1e-6 elsewhere. Loads of the table.
COMPUTED, TABULATED = 400, 4000

# Factors of the radii at which the model is solved lie this number of standard deviations apart.
APART = 2.0


@dataclass(frozen=True, eq=False)
class Response:
    """A0 over the load P/E* and the factor s of the radii, by interpolation.

    For independent asperities ``A0(P/E*, s) = s A0(P/E* / sqrt(s), 1)`` is exact. The difference of the
    model is interpolated between ``COMPUTED`` loads and by a parabola in s.
    """

    step: float  # of the coordinate (P/E* / sqrt(s))^(2/3), in which the area of small loads is linear
    apart: float  # distance of the three factors; 0 where s is always 1
    table: FloatArray  # (3, TABULATED), coefficients of the parabola in (s - 1) / apart [mm^2]

    @staticmethod
    def of(surface: Surface, model: Model, load: float, radius_sd: float) -> Response:
        """Return the response up to a rescaled load [mm^2], for factors of a standard deviation radius_sd.

        Raise NotConverged if the model has no solution at one of the loads.
        """
        coordinate = np.linspace(0.0, load ** (2.0 / 3.0), TABULATED)
        alone = Independent().areas(surface, coordinate**1.5, surface.height[None])[0]
        some = np.linspace(0.0, coordinate[-1], COMPUTED)
        base = Independent().areas(surface, some**1.5, surface.height[None])[0]
        apart = APART * radius_sd
        scaled = []
        for factor in (1.0 - apart, 1.0, 1.0 + apart) if apart > 0.0 else (1.0,):
            loads, radius = np.sqrt(factor) * some**1.5, factor * surface.radius[None]
            area = model.areas(surface, loads, surface.height[None], radius)[0]
            if not np.isfinite(area).all():
                first = loads[~np.isfinite(area)][0]
                raise NotConverged(f"the model has no solution at the rescaled load {first:.3g} mm^2")
            scaled.append(alone + np.interp(coordinate, some, area / factor - base))
        low, middle, high = scaled if apart > 0.0 else (scaled[0],) * 3
        parabola = np.array([middle, (high - low) / 2.0, (high + low) / 2.0 - middle])
        return Response(coordinate[1], apart, parabola)

    def area(self, load: FloatArray, factor: FloatArray) -> FloatArray:
        """Return A0 [mm^2] at rescaled loads [mm^2] and factors of the radii; 0 below load 0."""
        scaled = np.cbrt(np.maximum(load, 0.0) ** 2 / factor) / self.step
        # the last step continues beyond the table
        lower = np.minimum(scaled.astype(np.int64), TABULATED - 2)
        part = scaled - lower
        constant, linear, square = (row[lower] + part * (row[lower + 1] - row[lower]) for row in self.table)
        x = (factor - 1.0) / self.apart if self.apart > 0.0 else np.zeros(1)
        return np.asarray(factor * (constant + x * (linear + x * square)))
