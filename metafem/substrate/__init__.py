"""Elastic coupling of the asperities through the block."""

from metafem.substrate.substrate import Substrate

__all__ = ["Substrate"]
