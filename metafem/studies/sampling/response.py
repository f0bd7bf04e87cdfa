"""The area of one surface as a function of the load and of a common factor of its radii."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.surface import Surface

# Loads at which the difference from independent asperities is computed; under a layer the error of A0 is
# then below 0.5 % at the entry of a contact, and 1e-6 elsewhere. Loads of the table.
COMPUTED, TABULATED = 400, 4000

# Factors of the radii at which the model is solved lie this number of standard deviations apart.
APART = 2.0


@dataclass(frozen=True, eq=False)
class Response:
    """A0 over the load P/E* and the factor s of the radii, by interpolation.

    For independent Hertz contacts ``A0(P/E*, s) = s A0(P/E* / sqrt(s), 1)`` is exact; for power caps rho^n
    with s^m in place of sqrt(s) and m = 1 - 1/n, ``s^(2 m)`` in place of s. The difference of the model is
    interpolated between ``COMPUTED`` loads and by a parabola in s. Other laws are treated like Hertz's.
    """

    power: float  # n
    # of the coordinate (P/E* / s^m)^(2/(n + 1)), in which the area of small loads is linear
    step: float
    apart: float  # distance of the three factors; 0 where s is always 1
    table: FloatArray  # (3, TABULATED), coefficients of the parabola in (s - 1) / apart [mm^2]

    @staticmethod
    def of(surface: Surface, model: Model, load: float, radius_sd: float) -> Response:
        """Return the response up to a rescaled load [mm^2], for factors of a standard deviation radius_sd.

        Raise NotConverged if the model has no solution at one of the loads.
        """
        law = contact_of(model)
        power = law.without_adhesion.power or 2.0
        independent, by_load, by_radius = Independent(contact=law), 0.5 * (power + 1.0), 1.0 - 1.0 / power
        coordinate = np.linspace(0.0, load ** (1.0 / by_load), TABULATED)
        alone = independent.areas(surface, coordinate**by_load, surface.height[None])[0]
        some = np.linspace(0.0, coordinate[-1], COMPUTED)
        base = independent.areas(surface, some**by_load, surface.height[None])[0]
        apart = APART * radius_sd
        scaled = []
        for factor in (1.0 - apart, 1.0, 1.0 + apart) if apart > 0.0 else (1.0,):
            loads, radius = factor**by_radius * some**by_load, factor * surface.radius[None]
            area = model.areas(surface, loads, surface.height[None], radius)[0]
            if not np.isfinite(area).all():
                first = loads[~np.isfinite(area)][0]
                raise NotConverged(f"the model has no solution at the rescaled load {first:.3g} mm^2")
            scaled.append(alone + np.interp(coordinate, some, area / factor ** (2.0 * by_radius) - base))
        low, middle, high = scaled if apart > 0.0 else (scaled[0],) * 3
        parabola = np.array([middle, (high - low) / 2.0, (high + low) / 2.0 - middle])
        return Response(power, coordinate[1], apart, parabola)

    def area(self, load: FloatArray, factor: FloatArray) -> FloatArray:
        """Return A0 [mm^2] at rescaled loads [mm^2] and factors of the radii; 0 below load 0."""
        by_radius = 1.0 - 1.0 / self.power
        relative = np.maximum(load, 0.0) / factor**by_radius
        scaled = relative ** (2.0 / (self.power + 1.0)) / self.step
        # the last step continues beyond the table
        lower = np.minimum(scaled.astype(np.int64), TABULATED - 2)
        part = scaled - lower
        constant, linear, square = (row[lower] + part * (row[lower + 1] - row[lower]) for row in self.table)
        x = (factor - 1.0) / self.apart if self.apart > 0.0 else np.zeros(1)
        return np.asarray(factor ** (2.0 * by_radius) * (constant + x * (linear + x * square)))
