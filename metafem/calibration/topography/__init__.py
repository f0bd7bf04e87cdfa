"""Measured topography: base plane, spherical caps, the made surface, and corrected heights."""
