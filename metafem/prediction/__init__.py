"""Equilibria and friction laws of a surface, with loads in N."""

from metafem.prediction.branch_fit import BranchFit
from metafem.prediction.contact_state import ContactState
from metafem.prediction.equilibrium import equilibrium
from metafem.prediction.friction_law import friction_law, law_at
from metafem.prediction.law import FrictionLaw

__all__ = ["BranchFit", "ContactState", "FrictionLaw", "equilibrium", "friction_law", "law_at"]
