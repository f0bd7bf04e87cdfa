"""What a design predicts at the loads of a measured law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.inversion import Design
from metafem.prediction import FrictionLaw, friction_law
from metafem.progress import doing


@dataclass(frozen=True, eq=False)
class Prediction:
    """Rescaled friction of a design at measured loads (m,) and at operating points (q,) [mm^2], and slope."""

    friction: FloatArray
    slope: FloatArray  # (m,), mean slope over the error bar of the load [-]
    operating: FloatArray


@doing("computing the law of the design at the measured loads")
def predicted_at(
    measured: MeasuredLaw, point: NDArray[np.intp], design: Design | FrictionLaw, operating: FloatArray
) -> Prediction:
    """Return the prediction at some points of a law, and at other rescaled loads (q,) [mm^2]."""
    x, sd = measured.rescaled_load[point], measured.rescaled_load_sd[point]
    end = float((design.law if isinstance(design, Design) else design).rescaled_load[-1])
    middle = np.clip(x, 0.0, end)
    low, high = np.clip(x - sd, 0.0, end), np.clip(x + sd, 0.0, end)
    # where the whole error bar lies below 0, the slope at the smallest loads
    high = np.where(high > low, high, np.minimum(sd, end))
    loads, place = np.unique(np.concatenate([middle, low, high, operating]), return_inverse=True)
    friction = _law(measured, design, loads)[place]
    at_middle, at_low, at_high, at_operating = np.split(friction, np.cumsum([len(x)] * 3))
    return Prediction(at_middle, (at_high - at_low) / (high - low), at_operating)


def _law(measured: MeasuredLaw, design: Design | FrictionLaw, rescaled_load: FloatArray) -> FloatArray:
    """Return the rescaled friction at increasing rescaled loads."""
    if isinstance(design, FrictionLaw):
        load, friction = np.append(0.0, design.rescaled_load), np.append(0.0, design.rescaled_friction)
        found: FloatArray = np.interp(rescaled_load, load, friction)
        return found
    # the material of the part: adhesion is compared with its modulus, not with that of the design
    surface = design.surface.replaced(material=measured.material)
    load = measured.material.composite_modulus * rescaled_load
    return friction_law(surface, design.law.model, load=load).rescaled_friction
