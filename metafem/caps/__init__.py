"""Shapes of caps."""

from metafem.caps.cap import Cap, Caps, caps_of
from metafem.caps.profile import Profile
from metafem.caps.shapes import SPHERE, Paraboloid, Power, Sphere

__all__ = ["SPHERE", "Cap", "Caps", "Paraboloid", "Power", "Profile", "Sphere", "caps_of"]
