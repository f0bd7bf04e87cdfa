"""Resolved contacts: the pressure on cells of a grid."""

from metafem.models.boundary_elements.field import ContactField
from metafem.models.boundary_elements.model import BoundaryElements

__all__ = ["BoundaryElements", "ContactField"]
