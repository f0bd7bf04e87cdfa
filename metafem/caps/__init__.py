"""Shapes of caps."""

from metafem.caps.profile import Profile
from metafem.caps.shapes import SPHERE, Cap, Caps, Paraboloid, Power, Sphere, caps_of

__all__ = ["SPHERE", "Cap", "Caps", "Paraboloid", "Power", "Profile", "Sphere", "caps_of"]
