"""Parts with drawn errors, and their measured laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import metafem as mf
from metafem.calibration import MeasuredLaw, MeasurementErrors, Priors
from metafem.calibration.diagnosis.causes import Causes, Made
from metafem.calibration.diagnosis.linearised import Linear, Scene, response
from metafem.models.model import contact_of

ERRORS = MeasurementErrors()
NOTHING = Priors(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
COMMON = Priors(height_sd=0.0, radius_sd=0.0)
LOADS = np.linspace(0.03, 0.6, 20)


def design(shape=(5, 5)) -> mf.Surface:
    """Return exponential heights above 0.05 mm, at random sites, as those of Fig. 4 of the paper."""
    n = shape[0] * shape[1]
    heights = 0.05 - 0.03 * np.log(1.0 - (np.arange(n) + 0.5) / n)
    return mf.Surface.square_lattice(
        np.random.default_rng(0).permutation(heights),
        shape,
        1.5,
        radius=0.526,
        material=mf.Material(1.36),
        friction=mf.Friction(0.404, 0.85),
        block=mf.Block(20.0, 20.0, 7.2),
    )


def measured(
    surface: mf.Surface,
    *,
    rng: np.random.Generator | None = None,
    stiffer: float = 1.0,
    friction: float = 1.0,
    areas: bool = True,
    forces: bool = True,
    model: mf.Model | None = None,
) -> MeasuredLaw:
    """Return the law of a part with factors of E* and sigma B, with the paper's noise if rng is given."""
    nominal = surface.material
    material = replace(nominal, composite_modulus=stiffer * nominal.composite_modulus)
    used = mf.Independent() if model is None else model
    load = LOADS / material.composite_modulus
    part = Causes.of(surface.replaced(material=material), LOADS, LOADS, NOTHING, False).made(0.0 * LOADS)
    area = np.maximum(response(used, part, load).area, 0.0)
    force = friction * surface.friction.shear_strength * surface.friction.area_ratio * area.sum(axis=1)
    found = LOADS
    if rng is not None:
        found = LOADS + ERRORS.of_load(LOADS) * rng.standard_normal(LOADS.shape)
        force = force + ERRORS.of_friction_force(force) * rng.standard_normal(force.shape)
        area = np.maximum(area + ERRORS.of_area(area) * rng.standard_normal(area.shape), 0.0)
    return MeasuredLaw(
        found,
        friction_force=force if forces else None,
        asperity_area=area if areas else None,
        material=nominal,
        friction=surface.friction,
    )


def scene(model: mf.Model, priors: Priors, areas: bool, part: mf.Surface) -> Scene:
    """Return the part with its measured values without noise."""
    law = measured(part, areas=areas, model=None if part.cap == mf.Paraboloid() else model)
    causes = Causes.of(part, law.load, law.load_sd, priors, True, contact_of(model).adhesive)
    return Scene(model, causes, law, part.friction)


def exact(surface: mf.Surface) -> Made:
    """Return a part without errors."""
    return Causes.of(surface, np.ones(1), np.ones(1), NOTHING, False).made(np.zeros(1))


def computed(scene: Scene, z: np.ndarray) -> np.ndarray:
    """Return the measured values less the residuals."""
    at = scene.linear(z, np.zeros((len(z), len(z))))
    return np.concatenate([-at.residual * at.sd, at.indentation])


def gaussian(matrix: np.ndarray, data: np.ndarray, sd: np.ndarray):
    """Return the linear observations data = matrix z with Gaussian errors."""
    none = np.zeros(0)

    def linear(z: np.ndarray, covariance: np.ndarray) -> Linear:
        nothing = np.zeros((0, len(z)))
        return Linear((data - matrix @ z) / sd, matrix / sd[:, None], sd, none, nothing, none)

    return linear
