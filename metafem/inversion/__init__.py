"""From a wanted friction law to the heights that produce it."""

from metafem.inversion.bounds import achievable_friction_coefficients, plasticity_index
from metafem.inversion.design import Design, DesignStatus, design
from metafem.inversion.limits import Limits
from metafem.inversion.target import BilinearLaw, LinearLaw, OperatingPoints, Target

__all__ = [
    "BilinearLaw",
    "Design",
    "DesignStatus",
    "Limits",
    "LinearLaw",
    "OperatingPoints",
    "Target",
    "achievable_friction_coefficients",
    "design",
    "plasticity_index",
]
