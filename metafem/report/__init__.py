"""Report pages and their figures."""

import lazy_loader

# The stub lists the module of each public name; a module is imported when its name is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
