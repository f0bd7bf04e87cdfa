"""Finite elements: a second, independent theory of the same contacts."""

from metafem.fe.block import Block3D

__all__ = ["Block3D"]
