"""Models of the complete interface, which compute loads and contact areas of a surface under a plane."""

from metafem.models.automatic import Automatic
from metafem.models.boundary_elements.field import ContactField
from metafem.models.boundary_elements.model import BoundaryElements
from metafem.models.curve import Curve, ModelError, RescaledState, Sensitivity, Status
from metafem.models.independent import Independent
from metafem.models.interacting.model import Interacting
from metafem.models.model import Model, Sensitive

__all__ = [
    "Automatic",
    "BoundaryElements",
    "ContactField",
    "Curve",
    "Independent",
    "Interacting",
    "Model",
    "ModelError",
    "RescaledState",
    "Sensitive",
    "Sensitivity",
    "Status",
]
