"""From heights to loads: models of the whole interface."""

from metafem.models.boundary_elements import BoundaryElements
from metafem.models.equilibrium import equilibrium
from metafem.models.independent import Independent
from metafem.models.model import ContactState, Curve, Model, Status

__all__ = ["BoundaryElements", "ContactState", "Curve", "Independent", "Model", "Status", "equilibrium"]
