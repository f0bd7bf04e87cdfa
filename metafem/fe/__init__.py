"""Finite-element solutions of the contact, independent of the models, to check the models."""

import lazy_loader

# As in `metafem`, names are imported when they are first used, so that scikit-fem is loaded only if needed.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
