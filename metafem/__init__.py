"""Inverse design of surfaces with spherical asperities for a target friction law.

metafem computes the heights of spherical asperities from a target friction law, predicts the law of a
surface under models of increasing detail, and writes the files to make the part.

All quantities are in mm, N and MPa, and all angles in radians. Compression is positive. The separation is the
distance from the undeformed base plane of the asperities to the rigid plane. The approach is the height of
the tallest summit minus the separation. *Rescaled* quantities are the load P/E* and the friction F/(sigma B)
= A0, both in mm^2.
"""

import lazy_loader

# The stub lists the module of each public name. A module is imported when one of its names is first used.
_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name != "__version__":
        return _public(name)
    from importlib.metadata import version

    return version("metafem")
