"""One asperity against the plane."""

from metafem.asperity.contact import Contact
from metafem.asperity.hertz import Hertz

__all__ = ["Contact", "Hertz"]
