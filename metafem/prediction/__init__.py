"""Equilibria and friction laws of surfaces, with loads in N."""

from metafem.prediction.base_law import BranchFit, fit_branch
from metafem.prediction.law import FrictionLaw, default_loads, friction_law, law_of_curve
from metafem.prediction.sliding import Onset, onset
from metafem.prediction.state import ContactState, equilibrium
from metafem.prediction.tolerances import Tolerances

__all__ = [
    "BranchFit",
    "ContactState",
    "FrictionLaw",
    "Onset",
    "Tolerances",
    "default_loads",
    "equilibrium",
    "fit_branch",
    "friction_law",
    "law_of_curve",
    "onset",
]
