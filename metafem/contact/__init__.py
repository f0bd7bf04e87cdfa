"""Contact of one asperity and a rigid plane."""

from metafem.contact.by_profile import Elastic
from metafem.contact.cap_compliance import pedestal_compliance
from metafem.contact.elastic import Hertz
from metafem.contact.jackson_green import JacksonGreen
from metafem.contact.jkr import JKR
from metafem.contact.kogut_etsion import KogutEtsion
from metafem.contact.law import Contact
from metafem.contact.tabulated import TabulatedContact

__all__ = [
    "JKR",
    "Contact",
    "Elastic",
    "Hertz",
    "JacksonGreen",
    "KogutEtsion",
    "TabulatedContact",
    "pedestal_compliance",
]
