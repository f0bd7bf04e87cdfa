"""Surfaces with a friction law of your choice.

metafem inverts a wanted friction law into the heights of spherical asperities, predicts the law of a
surface under models of increasing truth, and writes the files to make the part.

Units are mm, N and MPa everywhere, angles are in radians, compression is positive. The separation is
the distance from the rigid plane to the undeformed base plane of the asperities; the approach is the
tallest summit minus the separation. *Rescaled* means load P/E* and friction F/(sigma B) = A0, both in
mm^2.
"""

import lazy_loader

# Where each public name lives stands in the stub; each is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
