"""Load as a function of contact area for a calibration sample with E* = 1 and without adhesion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem.caps import Profile
from metafem.contact import JKR, Contact, Elastic, Hertz, TabulatedContact
from metafem.contact.law import checked_contact
from metafem.errors import refuse_if

# Default contact law.
HERTZ = Hertz()

# Contact radius over R at which the slope of an open contact is evaluated.
OPEN = 1e-6


@dataclass(frozen=True, eq=False)
class AreaCurve:
    """Rescaled load as a function of contact area.

    Attributes
    ----------
    load_and_slope : callable
        Returns P/E* [mm^2] and its derivative with respect to the area [-] for contact areas (..., n) [mm^2].
    largest : float or ndarray, (n,)
        Largest areas that the law describes [mm^2]; infinite if there is no limit.
    """

    load_and_slope: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
    largest: float | FloatArray


@dataclass(frozen=True)
class Sample:
    """Sample of a compression test, whose contacts are far apart.

    Parameters
    ----------
    contacts : int
        Number of contacts that share a load; default: 1. If only their total area was measured, the contacts
        are assumed to be equal.
    radius_sd : float
        Standard deviation of R [mm], common to all points; default: 0. Caps with a profile or a table are
        scaled in all dimensions.
    poisson_ratio : float
        Poisson's ratio of the material [-]; default: 0.5.
    contact : Contact
        Elastic contact law of a cap, without adhesion; default: `metafem.Hertz`.

    Raises
    ------
    InvalidInput
        If the contact law is adhesive or plastic, or takes the caps of a surface.

    Examples
    --------
    >>> Sample(contacts=5, radius_sd=0.005).contact
    Hertz()
    """

    contacts: int = 1
    radius_sd: float = 0.0
    poisson_ratio: float = 0.5
    contact: Contact = HERTZ

    def __post_init__(self) -> None:
        check.integer("contacts", self.contacts, at_least=1)
        check.member(self, "radius_sd", at_least=0.0)
        check.member(self, "poisson_ratio", **check.POISSON)
        law = checked_contact(self.contact)
        without = "; give the cap, such as metafem.Hertz()"
        of_one_modulus = isinstance(law, TabulatedContact) and law.material is None
        for holds, reason in (
            (law.adhesive, f"has an adhesion energy, which is fitted{without}"),
            (law.plastic, f"is plastic; E* is fitted to an elastic law{without}"),
            (law == Elastic(), f"takes the caps of a surface{without}"),
            (
                of_one_modulus,
                "has loads in N for one E*, which must be known: contact.for_material(material)",
            ),
        ):
            refuse_if(holds, f"contact = {shown(law)} {reason}")

    def curve(self, radius: float, scale: float) -> AreaCurve:
        """Return the load curve of one contact, with the radius multiplied by `scale`."""
        law = self.contact if scale == 1.0 else scaled_cap(self.contact, scale)
        return cap_curve(law, scale * radius)

    def refuse_radius(self, radius: float) -> None:
        """Raise InvalidInput if a radius [mm] is below its error."""
        given = Given("radius", radius)
        less = "must be less than the radius, {.number}"
        refuse_if(self.radius_sd >= radius, less, given, key="radius_sd", value=self.radius_sd)


def cap_curve(cap: Contact, radius: float) -> AreaCurve:
    """Return the load curve of an isolated contact with a cap of this radius [mm]."""

    deepest = float(cap.largest_indentation(radius))
    widest = float(cap.contact_radius(deepest, radius)) if math.isfinite(deepest) else math.inf

    def load_and_slope(area: FloatArray) -> tuple[FloatArray, FloatArray]:
        closed = np.clip(np.sqrt(area / math.pi), OPEN * radius, widest)
        load = np.where(area > 0.0, cap.load(closed, radius), 0.0)
        return load, np.asarray(cap.stiffness(closed, radius) / cap.area_slope(closed, radius))

    return AreaCurve(load_and_slope, math.pi * widest**2)


def scaled_cap(cap: Contact, scale: float) -> Contact:
    """Return the contact law of a scaled cap; a law without a table or profile is unchanged."""
    if isinstance(cap, TabulatedContact):
        depth, load, area = cap.table
        return TabulatedContact(scale * depth, scale**2 * load, scale**2 * area, material=cap.material)
    if isinstance(cap, Elastic) and isinstance(cap.cap, Profile):
        profile = cap.cap.profile
        if callable(profile):
            return Elastic(Profile(lambda rho: scale * profile(rho / scale), scale * cap.cap.reach))
        return Elastic(Profile(scale * profile))
    return cap


def adhesive_cap(cap: Contact, adhesion_energy: float, modulus: float) -> Contact:
    """Return the contact law of the cap for this E* [MPa], adhesive if w > 0 [N/mm]."""
    if isinstance(cap, TabulatedContact) and cap.material is not None:
        depth, load, area = cap.table
        return TabulatedContact(depth, load * (modulus / cap.material.composite_modulus), area)
    return JKR(adhesion_energy, cap) if adhesion_energy > 0.0 and cap.largest_order > 1 else cap
