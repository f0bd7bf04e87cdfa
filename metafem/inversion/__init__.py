"""Design of asperity heights that produce a target friction law."""

from metafem.inversion.density import achievable_friction_coefficients
from metafem.inversion.design import design
from metafem.inversion.infeasible import achievable_load_range, feasible_region, plasticity_index
from metafem.inversion.laws import Band, OperatingPoints, PowerLaw, SampledLaw
from metafem.inversion.limits import Limits
from metafem.inversion.lines import BilinearLaw, LinearLaw, MultilinearLaw
from metafem.inversion.result import Design, DesignStatus
from metafem.inversion.sites import arrange
from metafem.inversion.target_law import Target
from metafem.inversion.tools import PowerRange, RadiusRange, Tool

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
