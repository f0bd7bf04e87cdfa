"""Quantities of a surface besides friction: tangential stiffness, conductance and pull-off force."""

from metafem.prediction.quantities.conductance import Conductance, conductance
from metafem.prediction.quantities.pull_off import pull_off
from metafem.prediction.quantities.tangential import shear_modulus, tangential_stiffness

__all__ = ["Conductance", "conductance", "pull_off", "shear_modulus", "tangential_stiffness"]
