"""Finite elements: an independent computation of the contact, and checks of the models against it."""

from metafem.fe.axisymmetric.active_set import FoundContact, search_contact
from metafem.fe.axisymmetric.cap_compliance import measure_pedestal
from metafem.fe.axisymmetric.mesh import read_mesh
from metafem.fe.axisymmetric.press import PressedContact, Status, press
from metafem.fe.block3d.substrate import Block3D
from metafem.fe.checks import Check, Convergence, cap_check, cell_check, hertz_check, layer_check
from metafem.fe.large_strain.body import Equilibrium
from metafem.fe.large_strain.press import FiniteContact, press_finite

__all__ = [
    "Block3D",
    "Check",
    "Convergence",
    "Equilibrium",
    "FiniteContact",
    "FoundContact",
    "PressedContact",
    "Status",
    "cap_check",
    "cell_check",
    "hertz_check",
    "layer_check",
    "measure_pedestal",
    "press",
    "press_finite",
    "read_mesh",
    "search_contact",
]
