"""Asperities coupled through an elastic substrate."""

from metafem.models.interacting.model import Interacting

__all__ = ["Interacting"]
