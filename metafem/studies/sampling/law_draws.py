"""Random laws of a surface whose parameters have errors.

The areas at the random loads and radii are interpolated between laws of the model.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.studies.sampling.inputs import Inputs
from metafem.studies.sampling.slope import Slope
from metafem.surface import Surface

# Laws are computed for errors up to this number of standard deviations. Beyond it, with a probability below
# 1e-6, the area is extrapolated.
FARTHEST = 5.0

# Number of loads at which the difference from independent asperities is computed, and number of loads in the
# table. On a layer, the error of A0 is then below 0.5 % near loads at which a contact closes, and 1e-6
# elsewhere.
COMPUTED, TABULATED = 400, 4000

# The model is solved at three factors of the radii, which differ by this number of standard deviations.
APART = 2.0


@dataclass(frozen=True, eq=False)
class Response:
    """A0 as a function of the load P/E* and of a factor s of all radii, by interpolation.

    For independent power caps rho^n, ``A0(P/E*, s) = s^(2 m) A0(P/E* / s^m, 1)`` with m = 1 - 1/n is exact.
    Hertz contacts have n = 2 and m = 1/2; all other contact laws are treated like Hertz contacts. The
    difference between the model and this law is interpolated linearly between ``COMPUTED`` loads, and by a
    parabola in s.
    """

    power: float  # n
    # step of the coordinate (P/E* / s^m)^(2/(n + 1)), in which A0 is linear at small loads
    step: float
    apart: float  # difference between neighbouring factors s; 0 if s is always 1
    table: FloatArray  # (3, TABULATED), coefficients of the parabola in (s - 1) / apart [mm^2]

    @staticmethod
    def reaching(
        surface: Surface, model: Model, inputs: Inputs, load: FloatArray, fit: Slope | None
    ) -> Response:
        """Return the response up to the largest likely rescaled load, from loads (k,) [N] and a slope fit."""
        sd = {name: float(values.max()) for name, values in zip(inputs.names, inputs.sd, strict=True)}
        modulus = surface.material.composite_modulus
        lowest = modulus - FARTHEST * sd.get("composite_modulus", 0.0)
        largest = (float(load.max()) + FARTHEST * sd.get("load", 0.0)) / lowest
        if fit is not None:
            largest = max(largest, fit.load_range[1] * modulus / lowest)
        radius_sd = sd.get("radius", 0.0) / float(surface.radius.mean())
        return Response.of(surface, model, largest / np.sqrt(1.0 - FARTHEST * radius_sd), radius_sd)

    @staticmethod
    def of(surface: Surface, model: Model, load: float, radius_sd: float) -> Response:
        """Return the response up to a rescaled load [mm^2]; radius_sd: standard deviation of the factor s.

        Raise NotConverged if the model has no solution at one of the loads.
        """
        law = contact_of(model)
        power = law.without_adhesion.power or 2.0
        independent, by_load, by_radius = Independent(contact=law), 0.5 * (power + 1.0), 1.0 - 1.0 / power
        coordinate = np.linspace(0.0, load ** (1.0 / by_load), TABULATED)
        fine = independent.areas(surface, coordinate**by_load, surface.height[None])[0]
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
            scaled.append(fine + np.interp(coordinate, some, area / factor ** (2.0 * by_radius) - base))
        low, middle, high = scaled if apart > 0.0 else (scaled[0],) * 3
        parabola = np.array([middle, (high - low) / 2.0, (high + low) / 2.0 - middle])
        return Response(power, coordinate[1], apart, parabola)

    def area(self, load: FloatArray, factor: FloatArray) -> FloatArray:
        """Return A0 [mm^2] at rescaled loads [mm^2] and factors of the radii; 0 for negative loads."""
        by_radius = 1.0 - 1.0 / self.power
        relative = np.maximum(load, 0.0) / factor**by_radius
        scaled = relative ** (2.0 / (self.power + 1.0)) / self.step
        # beyond the table, extrapolate along its last step
        lower = np.minimum(scaled.astype(np.int64), TABULATED - 2)
        part = scaled - lower
        constant, linear, square = (row[lower] + part * (row[lower + 1] - row[lower]) for row in self.table)
        x = (factor - 1.0) / self.apart if self.apart > 0.0 else np.zeros(1)
        return np.asarray(factor ** (2.0 * by_radius) * (constant + x * (linear + x * square)))


@dataclass(frozen=True, eq=False)
class LawDraws:
    """Laws of a surface with random parameters.

    A draw has the values of all quantities that `outputs` names, one after the other.
    """

    surface: Surface
    inputs: Inputs
    response: Response
    fit: Slope | None
    load: FloatArray  # (k,) [N]
    friction_force: FloatArray | None  # (k,) [N], measured

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the quantities; the slope has one value, each of the others has k."""
        if self.friction_force is not None:
            names = ["area", "rescaled_load", "rescaled_friction", "deviation"]
        else:
            names = ["area"] + ["friction_force"] * (self.surface.friction is not None)
        return (*names, "slope") if self.fit is not None else tuple(names)

    @cached_property
    def nominal(self) -> FloatArray:
        """The outputs without errors, (q,)."""
        return np.asarray(self.law(np.full((1, len(self.inputs.names)), 0.5))[0])

    def law(self, unit: FloatArray) -> FloatArray:
        """Return the outputs (..., q) at points of the unit cube (..., p)."""
        errors = defaultdict(lambda: np.zeros(1), self.inputs.errors(unit))
        material, friction = self.surface.material, self.surface.friction
        modulus = material.composite_modulus + errors["composite_modulus"]
        factor = 1.0 + errors["radius"] / self.surface.radius.mean()
        load = (self.load + errors["load"]) / modulus
        found = {"area": self.response.area(load, factor)}
        if friction is not None:
            strength = friction.shear_strength + errors["shear_strength"]
            stress = strength * (friction.area_ratio + errors["area_ratio"])
            if self.friction_force is None:
                found["friction_force"] = stress * found["area"]
            else:
                found["rescaled_load"] = load
                found["rescaled_friction"] = (self.friction_force + errors["friction_force"]) / stress
                found["deviation"] = found["rescaled_friction"] - found["area"]
        if self.fit is not None:
            area = self.response.area(self.fit.load * material.composite_modulus / modulus, factor)
            # no matrix product: its last bits would depend on the number of threads
            found["slope"] = np.einsum("...k,k->...", area, self.fit.weight)[..., None]
        # a quantity that depends on no random parameter has the same value at all points
        parts = [
            np.broadcast_to(found[name], (*unit.shape[:-1], found[name].shape[-1])) for name in self.outputs
        ]
        return np.concatenate(parts, axis=-1)
