"""Design of asperity heights that produce a target friction law."""

from metafem.inversion.adjustment.correction import Correction, brought_into
from metafem.inversion.assessment import DesignStatus
from metafem.inversion.design import design
from metafem.inversion.elastic_design import design_for_hardness
from metafem.inversion.feasibility import (
    achievable_friction_coefficients,
    feasible_region,
    plasticity_index,
)
from metafem.inversion.limits import Limits
from metafem.inversion.placement.arrange import Arrangement, arrange
from metafem.inversion.placement.layout import Layout
from metafem.inversion.placement.objectives import FollowLaw, InsensitiveToTilt, Objective, WeightedObjectives
from metafem.inversion.result import Design
from metafem.inversion.strategies.proportional import achievable_load_range
from metafem.inversion.targets.band import Band
from metafem.inversion.targets.laws import OperatingPoints, PowerLaw, SampledLaw
from metafem.inversion.targets.multilinear import MultilinearLaw
from metafem.inversion.targets.straight import BilinearLaw, LinearLaw
from metafem.inversion.targets.target import Target
from metafem.inversion.tools.ranges import PowerRange, RadiusRange
from metafem.inversion.tools.tool import Tool

__all__ = [
    "Arrangement",
    "Band",
    "BilinearLaw",
    "Correction",
    "Design",
    "DesignStatus",
    "FollowLaw",
    "InsensitiveToTilt",
    "Layout",
    "Limits",
    "LinearLaw",
    "MultilinearLaw",
    "Objective",
    "OperatingPoints",
    "PowerLaw",
    "PowerRange",
    "RadiusRange",
    "SampledLaw",
    "Target",
    "Tool",
    "WeightedObjectives",
    "achievable_friction_coefficients",
    "achievable_load_range",
    "arrange",
    "brought_into",
    "design",
    "design_for_hardness",
    "feasible_region",
    "plasticity_index",
]
