"""One asperity against the plane."""

from metafem.contact.cap_compliance import pedestal_compliance
from metafem.contact.caps import PowerCap, SphericalCap
from metafem.contact.elastic import Hertz
from metafem.contact.law import Contact
from metafem.contact.profile import AxisymmetricCap

__all__ = ["AxisymmetricCap", "Contact", "Hertz", "PowerCap", "SphericalCap", "pedestal_compliance"]
