"""Inverse design of friction laws by surfaces of spherical caps.

metafem computes the heights of spherical asperities from a target friction law, predicts the law of a
surface under models of increasing detail, and writes the files to make the part.

Units are mm, N and MPa everywhere, angles are in radians, compression is positive. The separation is
the distance from the rigid plane to the undeformed base plane of the asperities; the approach is the
tallest summit minus the separation. *Rescaled* means load P/E* and friction F/(sigma B) = A0, both in
mm^2.
"""

import lazy_loader

# The stub lists the module of each public name; a name is imported when it is first used.
_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name != "__version__":
        return _public(name)
    from importlib.metadata import version

    return version("metafem")
