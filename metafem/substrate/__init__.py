"""Elastic coupling of the asperities through the block."""

from metafem.substrate.bonded_layer import BondedLayer
from metafem.substrate.half_space import HalfSpace
from metafem.substrate.protocol import Substrate
from metafem.substrate.radial import Radial

__all__ = ["BondedLayer", "HalfSpace", "Radial", "Substrate"]
