"""Equilibria and friction laws of a surface, with loads in N."""

from metafem.prediction.contact_state import ContactState
from metafem.prediction.equilibrium import equilibrium
from metafem.prediction.friction_law import BranchFit, FrictionLaw, friction_law

__all__ = ["BranchFit", "ContactState", "FrictionLaw", "equilibrium", "friction_law"]
