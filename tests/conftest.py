"""Settings of the property-based tests."""

from hypothesis import settings

# The first example of a run may compile a kernel.
settings.register_profile("metafem", deadline=None)
settings.load_profile("metafem")
