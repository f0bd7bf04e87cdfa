"""Finite elements: a second theory of the same contact, and the checks it makes."""

from metafem.fe.block import Block3D
from metafem.fe.checks import Check, Convergence, cap_check, cell_check, hertz_check, layer_check
from metafem.fe.finite_body import Equilibrium
from metafem.fe.finite_strain import FiniteContact, press_finite
from metafem.fe.mesh import read_mesh
from metafem.fe.pedestal import measure_pedestal
from metafem.fe.press import PressedContact, Status, press
from metafem.fe.search import FoundContact, search_contact

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
