"""Quantities that a target may prescribe in place of the area.

The inversion reads the area of a law alone. A target of another quantity is therefore inverted for contacts
whose load is that of the model and whose "area" is the quantity of one contact: the stiffness ``2 a``, the
rescaled conductance ``2 a`` or the tangential stiffness ``4 (1 - nu)/(2 - nu) a``, all in mm and divided by
E* or by 2/(rho_1 + rho_2). The strategies, bounds and searches are then those for friction. The friction of
coated caps is such a quantity, too: ``w pi a^2`` with the weight w of the coating. With interaction
the quantity is no sum over the contacts; there it is that of a `QuantityModel`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from metafem._given import shown
from metafem._validate import FloatArray
from metafem.caps.cap import Cap
from metafem.contact import Contact
from metafem.contact.by_profile import MixedCaps
from metafem.contact.law import Values
from metafem.errors import InvalidInput, refuse_if
from metafem.inversion.quantities.model import QuantityModel
from metafem.material import Material
from metafem.models import Model
from metafem.models.model import contact_of, with_contact
from metafem.prediction.quantities.tangential import shear_modulus
from metafem.substrate import Radial
from metafem.surface import Surface

Of = Literal["friction", "stiffness", "tangential_stiffness", "conductance"]
FRICTION: Of = "friction"

# What each quantity divided by, as targets state it [mm].
RESCALED = {
    "stiffness": "k/E*",
    "tangential_stiffness": "k_t/E*",
    "conductance": "(rho_1 + rho_2) G/2",
}


def checked(of: Any) -> Of:
    """Return the name of a quantity, or raise InvalidInput."""
    names: tuple[Of, ...] = get_args(Of)
    for name in names:
        if of == name:
            return name
    listed = ", ".join(f'"{name}"' for name in names)
    raise InvalidInput(
        f"of = {shown(of)} is not a quantity of a target; it must be one of {listed}", key="of"
    )


def words(of: Of) -> str:
    """Return the name of a quantity for a sentence."""
    return of.replace("_", " ")


def measured(model: Model, of: Of, surface: Surface) -> Model:
    """Return the model whose areas are the quantity of a surface.

    Raise InvalidInput if the quantity is not known under the model, or if the asperities differ in friction.
    """
    if of == FRICTION:
        return model
    surface.refuse_coatings(f"a target of the {words(of)}")
    law = contact_of(model)
    refuse_if(
        law.largest_order == 1 and of == "stiffness",
        f"a target of the stiffness needs elastic contacts, whose stiffness is 2 E* a; {law!r} has none",
        key="model",
    )
    refuse_if(
        law.adhesive,
        f"a target of the {words(of)} needs contacts without adhesion; those of {law!r} jump",
        key="model",
    )
    contact = Measured(law, of)
    if not model.couples:
        return with_contact(model, contact)
    refuse_if(
        of == "conductance" and not hasattr(model, "conductance"),
        f"the model {model.name} has no conductance; use independent, half-space or layer",
        key="model",
    )
    substrate = model.reference.substrate
    refuse_if(
        of == "conductance" and not isinstance(substrate, Radial),
        f"a target of the conductance needs metafem.HalfSpace() or metafem.BondedLayer(); "
        f"{type(substrate).__name__} has no conduction",
        key="model",
    )
    return QuantityModel(model, contact, of, contact.for_material(surface.material).factor)


def measure(law: Contact) -> tuple[float, float]:
    """Return c and m of the "area" c a^m of the contacts of an elastic law."""
    own = law.laws[0] if isinstance(law, MixedCaps) else law
    return (own.factor, own.exponent) if isinstance(own, Measured) else (math.pi, 2.0)


def weighted(law: Contact, weight: float) -> Contact:
    """Return the law whose areas are the rescaled friction of contacts with a weight; see `Friction`."""
    return law if weight == 1.0 else Measured(law, FRICTION, math.pi * weight, 2.0)


def of_area(law: Contact) -> Contact:
    """Return the law of which `weighted` has made a law; any other law itself."""
    return law.law if isinstance(law, Measured) and law.of == FRICTION else law


@dataclass(frozen=True)
class Measured(Contact):
    """A contact law whose "area" is ``factor a^exponent``, a quantity that depends on the contact radius a.

    The nominal contact radius of this law is ``sqrt(factor a^exponent/pi)``; its loads and indentations are
    those of `law`. factor: of quantities other than friction, set by `for_material`.
    """

    largest_order: ClassVar[int] = 1

    law: Contact
    of: Of
    factor: float = 2.0
    exponent: float = 1.0

    def __repr__(self) -> str:
        """Return the law with its quantity."""
        return f"{self.law!r} by {words(self.of)}"

    def for_material(self, material: Material) -> Measured:
        """Return the law for a material."""
        factor = self.factor
        if self.of == "tangential_stiffness":
            factor = 8.0 * shear_modulus(material) / material.composite_modulus
        return replace(self, law=self.law.for_material(material), factor=factor)

    def bound(self, surface: Surface) -> Contact:
        """Return the law for the material and the caps of a surface."""
        own, law = self.for_material(surface.material), self.law.bound(surface)
        if isinstance(law, MixedCaps):
            return MixedCaps(tuple(Measured(each, self.of, own.factor) for each in law.laws))
        return Measured(law, self.of, own.factor)

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return what the methods take as `radius`, for all asperities of a surface."""
        return self.law.summits(surface, radius)

    def fits(self, cap: Cap) -> bool:
        """Return whether the law describes caps of this shape."""
        return self.law.fits(cap)

    def breaks(self, radius: float) -> FloatArray:
        """Return the nominal contact radii [mm] between which the law is smooth."""
        return self._nominal(self.law.breaks(radius))

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Return the largest indentation [mm] for which the law is valid."""
        return self.law.largest_indentation(radius)

    def contact_radius(self, indentation: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the nominal contact radius [mm]; 0 for open contacts."""
        return self._nominal(self.law.contact_radius(indentation, radius))

    def indentation(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the indentation d [mm]."""
        return self.law.indentation(self._true(contact_radius), radius)

    def load(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the rescaled load P/E* [mm^2]."""
        return self.law.load(self._true(contact_radius), radius)

    def second_moment(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the second moment of the pressure over E* [mm^4]."""
        return self.law.second_moment(self._true(contact_radius), radius)

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the contact stiffness over E* [mm]."""
        return self.law.stiffness(self._true(contact_radius), radius)

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the derivative of the quantity with respect to the indentation; 0 for an open contact."""
        a = self._true(contact_radius)
        closed = a > 0.0
        one = np.where(closed, a, 1.0)
        slope = self.factor * self.exponent * one ** (self.exponent - 1.0)
        rate = slope * self.law.area_slope(one, radius) / (2.0 * math.pi * one)
        return np.asarray(np.where(closed, rate, 0.0))[()]

    def _nominal(self, contact_radius: Values) -> FloatArray:
        return np.sqrt(self.factor / math.pi * np.power(contact_radius, self.exponent))

    def _true(self, nominal: Values) -> FloatArray:
        return np.asarray((math.pi / self.factor * np.square(nominal)) ** (1.0 / self.exponent))
