"""Design of asperity heights that produce a target friction law."""

from metafem.inversion.assessment import DesignStatus
from metafem.inversion.design import design
from metafem.inversion.feasibility import (
    achievable_friction_coefficients,
    feasible_region,
    plasticity_index,
)
from metafem.inversion.limits import Limits
from metafem.inversion.result import Design
from metafem.inversion.sites import arrange
from metafem.inversion.strategies.proportional import achievable_load_range
from metafem.inversion.targets.band import Band
from metafem.inversion.targets.laws import OperatingPoints, PowerLaw, SampledLaw
from metafem.inversion.targets.multilinear import MultilinearLaw
from metafem.inversion.targets.straight import BilinearLaw, LinearLaw
from metafem.inversion.targets.target import Target
from metafem.inversion.tools.ranges import PowerRange, RadiusRange
from metafem.inversion.tools.tool import Tool

__all__ = [
    "Band",
    "BilinearLaw",
    "Design",
    "DesignStatus",
    "Limits",
    "LinearLaw",
    "MultilinearLaw",
    "OperatingPoints",
    "PowerLaw",
    "PowerRange",
    "RadiusRange",
    "SampledLaw",
    "Target",
    "Tool",
    "achievable_friction_coefficients",
    "achievable_load_range",
    "arrange",
    "design",
    "feasible_region",
    "plasticity_index",
]
