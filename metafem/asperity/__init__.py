"""One asperity against the plane."""

from metafem.asperity.contact import Contact
from metafem.asperity.hertz import Hertz
from metafem.asperity.pedestal import pedestal_compliance

__all__ = ["Contact", "Hertz", "pedestal_compliance"]
