"""Read and write specifications, measurements, result folders and part files."""

import lazy_loader

# The stub lists the module of each public name; a name is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
