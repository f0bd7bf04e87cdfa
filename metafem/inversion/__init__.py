"""From a target friction law to the heights that produce it."""

from metafem.inversion.assessment import DesignStatus
from metafem.inversion.bounds import achievable_friction_coefficients, plasticity_index
from metafem.inversion.design import Design, design
from metafem.inversion.feasibility import feasible_region
from metafem.inversion.limits import Limits
from metafem.inversion.placement.arrange import Arrangement, arrange
from metafem.inversion.placement.layout import Layout
from metafem.inversion.placement.objectives import FollowLaw, InsensitiveToTilt, Objective, Together
from metafem.inversion.radii import RadiusRange
from metafem.inversion.radius import design_radii, design_radius
from metafem.inversion.strategies.proportional import achievable_load_range
from metafem.inversion.targets.laws import (
    BilinearLaw,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
    Target,
)

__all__ = [
    "Arrangement",
    "BilinearLaw",
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
    "RadiusRange",
    "SampledLaw",
    "Target",
    "Together",
    "achievable_friction_coefficients",
    "achievable_load_range",
    "arrange",
    "design",
    "design_radii",
    "design_radius",
    "feasible_region",
    "plasticity_index",
]
