"""From a wanted friction law to the heights that produce it."""

from metafem.inversion.bounds import achievable_friction_coefficients, plasticity_index
from metafem.inversion.design import Design, design
from metafem.inversion.feasibility import feasible_region
from metafem.inversion.judge import DesignStatus
from metafem.inversion.limits import Limits
from metafem.inversion.target import (
    BilinearLaw,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
    Target,
)

__all__ = [
    "BilinearLaw",
    "Design",
    "DesignStatus",
    "Limits",
    "LinearLaw",
    "MultilinearLaw",
    "OperatingPoints",
    "PowerLaw",
    "SampledLaw",
    "Target",
    "achievable_friction_coefficients",
    "design",
    "feasible_region",
    "plasticity_index",
]
