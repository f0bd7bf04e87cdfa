"""Finite elements: an independent computation of the contact, and checks of the models against it."""

import lazy_loader

# As in metafem: scikit-fem is imported only where needed.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
