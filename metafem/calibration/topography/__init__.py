"""Measured topography: base plane, spherical caps and the made surface."""
