"""Measured topography: base plane, spherical caps, the made surface and corrections for the next one."""
