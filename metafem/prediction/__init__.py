"""Equilibria and friction laws of surfaces, with loads in N."""

from metafem.prediction.branch_fit import BranchFit, fit_branch
from metafem.prediction.contact_state import ContactState
from metafem.prediction.equilibria import equilibrium
from metafem.prediction.friction_law import default_loads, friction_law, law_of_curve
from metafem.prediction.law import FrictionLaw
from metafem.prediction.perturbation import Perturbed, Tolerances
from metafem.prediction.sliding import Onset, onset

__all__ = [
    "BranchFit",
    "ContactState",
    "FrictionLaw",
    "Onset",
    "Perturbed",
    "Tolerances",
    "default_loads",
    "equilibrium",
    "fit_branch",
    "friction_law",
    "law_of_curve",
    "onset",
]
