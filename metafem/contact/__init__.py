"""Contact of one asperity and a rigid plane."""

from metafem.contact.by_indentation import JacksonGreen, KogutEtsion, TabulatedContact
from metafem.contact.elastic import Elastic, Hertz
from metafem.contact.jkr import JKR
from metafem.contact.law import Contact
from metafem.contact.pedestal import pedestal_compliance

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
