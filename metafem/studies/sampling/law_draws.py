"""Draws of the law of a surface whose parameters have errors, batch by batch."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray
from metafem.models import Model
from metafem.studies.sampling.inputs import Inputs
from metafem.studies.sampling.response import Response
from metafem.studies.sampling.slope import Slope
from metafem.studies.sampling.sobol_indices import batch_means, exchanged
from metafem.surface import Surface

# Standard deviations up to which laws are computed; beyond, with a probability below 1e-6, the area is
# extrapolated.
FARTHEST = 5.0


@dataclass(frozen=True, eq=False)
class LawDraws:
    """Batches of the law of a surface for drawn parameters.

    The outputs of one draw are the quantities of `outputs`, one after the other.
    """

    surface: Surface
    inputs: Inputs
    response: Response
    fit: Slope | None
    load: FloatArray  # (k,) [N]
    friction_force: FloatArray | None  # (k,) [N], measured
    points: int  # of one batch
    seed: int

    @staticmethod
    def of(
        surface: Surface,
        model: Model,
        inputs: Inputs,
        fit: Slope | None,
        load: FloatArray,
        friction_force: FloatArray | None,
        points: int,
        seed: int,
    ) -> LawDraws:
        """Return the draws, with the areas up to the largest load that is likely to be drawn."""
        sd = {name: float(values.max()) for name, values in zip(inputs.names, inputs.sd, strict=True)}
        modulus = surface.material.composite_modulus
        lowest = modulus - FARTHEST * sd.get("composite_modulus", 0.0)
        largest = (float(load.max()) + FARTHEST * sd.get("load", 0.0)) / lowest
        if fit is not None:
            largest = max(largest, fit.load_range[1] * modulus / lowest)
        radius_sd = sd.get("radius", 0.0) / float(surface.radius.mean())
        response = Response.of(surface, model, largest / np.sqrt(1.0 - FARTHEST * radius_sd), radius_sd)
        return LawDraws(surface, inputs, response, fit, load, friction_force, points, seed)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the quantities, (k,) each except the slope."""
        if self.friction_force is not None:
            names = ["area", "rescaled_load", "rescaled_friction", "deviation"]
        else:
            names = ["area"] + ["friction_force"] * (self.surface.friction is not None)
        return (*names, "slope") if self.fit is not None else tuple(names)

    def __call__(self, batch: int) -> dict[str, np.ndarray]:
        """Return the means over one batch, from which all estimates are made."""
        unit = exchanged(self.seed, batch, self.inputs.groups, self.points)
        return {"means": batch_means(self.law(unit), self.nominal)}

    @cached_property
    def nominal(self) -> FloatArray:
        """Outputs (q,) without errors."""
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
            # no product of matrices: its last bits depend on the number of threads
            found["slope"] = np.einsum("...k,k->...", area, self.fit.weight)[..., None]
        # quantities on which no drawn parameter acts are the same for all points
        parts = [
            np.broadcast_to(found[name], (*unit.shape[:-1], found[name].shape[-1])) for name in self.outputs
        ]
        return np.concatenate(parts, axis=-1)
