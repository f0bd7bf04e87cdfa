"""Elastic coupling of the asperities through the block."""

from metafem.substrate.bonded_layer import BondedLayer
from metafem.substrate.radial import HalfSpace, Radial, Substrate

__all__ = ["BondedLayer", "HalfSpace", "Radial", "Substrate"]
