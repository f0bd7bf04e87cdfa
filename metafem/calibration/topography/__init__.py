"""Measured topography: base plane, spherical caps, the made surface and what to correct in the next one."""
