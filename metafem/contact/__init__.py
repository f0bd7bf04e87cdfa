"""One asperity against the plane."""

from metafem.contact.cap_compliance import pedestal_compliance
from metafem.contact.caps import PowerCap, SphericalCap
from metafem.contact.elastic import Hertz
from metafem.contact.law import Contact

__all__ = ["Contact", "Hertz", "PowerCap", "SphericalCap", "pedestal_compliance"]
