"""How the contacts of an image are measured."""

from __future__ import annotations

from dataclasses import dataclass

from metafem import _validate as check
from metafem._extras import refuse_missing
from metafem._given import shown
from metafem.errors import InvalidInput


@dataclass(frozen=True)
class Options:
    """The arguments of `contact_areas`, checked; None where a value is to be measured."""

    pixel_size: float
    threshold: float | None = None
    dark_level: float | None = None
    blur: float | None = None
    subpixel: bool = True
    bright_contacts: bool = False
    smallest_area: float | None = None

    def __post_init__(self) -> None:
        refuse_missing("skimage", "images", "measuring contact areas")
        check.member(self, "pixel_size", above=0.0)
        check.member(self, "threshold", optional=True)
        check.member(self, "dark_level", optional=True)
        check.member(self, "blur", optional=True, at_least=0.0)
        check.member(self, "smallest_area", optional=True, at_least=0.0)
        for name in ("threshold", "dark_level"):
            value = getattr(self, name)
            if value is not None and value >= 1.0:
                raise InvalidInput(f"{name} = {value:g} must be below 1, the grey level of the ground")
        for name in ("subpixel", "bright_contacts"):
            if not isinstance(getattr(self, name), bool):
                raise InvalidInput(f"{name} = {shown(getattr(self, name))} must be True or False")
