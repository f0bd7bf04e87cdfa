"""Finite elements: a second theory of the same contact."""

from metafem.fe.press import PressedContact, Status, press

__all__ = ["PressedContact", "Status", "press"]
