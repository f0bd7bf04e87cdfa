"""The protocol of contact laws."""

from __future__ import annotations

import math
from typing import Any, ClassVar, NamedTuple, Protocol, cast, runtime_checkable

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact.cap_geometry import SPHERES, CapShape, Values
from metafem.errors import InvalidInput
from metafem.material import Material
from metafem.notes import Note

__all__ = ["Contact", "Contacts", "Values", "area_change", "checked_contact", "contacts", "material_of"]

# Step of the contact radius for the derivative of D', relative.
STEP = 1e-3


@runtime_checkable
class Contact(Protocol):
    """Law of one axisymmetric contact, for unit E*: loads are P/E* [mm^2].

    A user-defined law derives from this class and defines the methods without a body here. It is passed to
    a model: ``Independent(contact=MyLaw())``. The contact radius a [mm] is the variable, R [mm] the radius of
    the summit; `curvature` [1/mm] is that of the displacement by other contacts, which adds
    ``curvature rho^2 / 2`` to the profile. All methods are vectorised.

    Attributes
    ----------
    largest_order : int
        3 for a frictionless elastic contact, whose load, second moment and indentation follow from one
        profile; 1 for a law given only as load and area over the indentation, which couples by point loads.
    similar : bool
        Whether the law is the same for all radii if all lengths are divided by R.
    adhesive : bool
        Whether contacts adhere: the load is negative for some contact radii, and contacts jump.
    plastic : bool
        Whether contacts stay flattened after unloading.
    individual : bool
        Whether the parameters are arrays (n,) with one value for each asperity, the last axis of all
        arguments; ``law.one(i)`` is then the law of asperity i.
    """

    largest_order: ClassVar[int] = 1
    similar: ClassVar[bool] = False
    adhesive: ClassVar[bool] = False
    plastic: ClassVar[bool] = False
    individual: ClassVar[bool] = False

    @property
    def scales_with_stress(self) -> bool:
        """Whether P/E* depends on E* (through an energy or a stress) as well as on the indentation."""
        return self.adhesive or self.largest_order == 1

    @property
    def power(self) -> float | None:
        """n of a cap rho^n without adhesion, for which A grows as d^(2/n) and P as d^(1 + 1/n); or None."""
        return None

    @property
    def without_adhesion(self) -> Contact:
        """The law without adhesion; the law itself if it has none."""
        return self

    def for_material(self, material: Material) -> Contact:
        """Return the law for unit E* of a material; the law itself if it has no energy or stress."""
        return self

    @property
    def count(self) -> int | None:
        """Number of asperities of an individual law; None for a law that applies to any number."""
        return None

    def one(self, i: int) -> Contact:
        """Return the law of asperity i; the law itself if all asperities share it."""
        return self

    def breaks(self, radius: float) -> FloatArray:
        """Increasing contact radii [mm] between which the law is smooth; empty if it is smooth everywhere."""
        return np.empty(0)

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Largest indentation [mm] that the law describes; infinite where there is none."""
        return np.full(np.shape(radius), math.inf)[()]

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """Return notes on approximations of the law at indentations (n,) [mm]."""
        return ()

    def unloaded(self, indentation: FloatArray, radius: FloatArray) -> tuple[Contact, FloatArray]:
        """Return the law after the largest indentations (n,) [mm], and the loss of height (n,) [mm].

        The returned law is that of the lowered summits. An elastic law returns itself.
        """
        return self, np.zeros(np.shape(indentation))

    def shape(self) -> CapShape:
        """Shape of the caps of a part; spheres of radius R, unless the law has another profile."""
        return SPHERES

    def contact_radius(self, indentation: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Contact radius a [mm] at an indentation d [mm]; 0 where d is negative: an open contact."""
        ...

    def indentation(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Indentation d [mm]."""
        ...

    def load(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Rescaled load P/E* [mm^2]."""
        ...

    def area(self, contact_radius: Values) -> FloatArray:
        """Real contact area pi a^2 [mm^2]."""
        return np.asarray(math.pi * np.square(contact_radius))[()]

    def second_moment(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Second moment of the pressure over E*, the integral of ``p rho^2`` over the contact [mm^4]."""
        ...

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Derivative of the rescaled load by the indentation [mm]."""
        ...

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Derivative of the real contact area by the indentation [mm]; 0 for an open contact."""
        ...

    def profile_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Derivative dd/da of the indentation of an elastic cap by the contact radius a > 0 [-]."""
        a = np.asarray(contact_radius, dtype=np.float64)
        return np.asarray(2.0 * math.pi * a / self.area_slope(a, radius, curvature))


def checked_contact(contact: object) -> Contact:
    """Return a contact law, or raise InvalidInput for anything else."""
    laws = "a contact law such as metafem.Hertz() or metafem.PowerCap(4)"
    check.instance("contact", contact, Contact, laws)
    return cast("Contact", contact)


def material_of(law: Any) -> Material:
    """Return the material of a law, or raise InvalidInput for a law without one."""
    if law.material is None:
        raise InvalidInput(f"{law!r} has no material yet: use it in a model, or call for_material(material)")
    return cast("Material", law.material)


class Contacts(NamedTuple):
    """Contacts at given indentations, all arrays of one shape."""

    load: FloatArray  # P/E* [mm^2]
    area: FloatArray  # [mm^2]
    stiffness: FloatArray  # derivative of the load by the indentation [mm]
    contact_radius: FloatArray  # [mm]


def contacts(law: Contact, indentation: FloatArray, radius: FloatArray) -> Contacts:
    """Return the undisturbed contacts at indentations [mm]; a negative one is an open contact."""
    a = law.contact_radius(indentation, radius)
    stiffness = law.stiffness(a, radius)
    # correct to first order in the rounding of a: near the equator of a sphere `load` loses digits
    missing = np.where(a > 0.0, indentation - law.indentation(a, radius), 0.0)
    return Contacts(law.load(a, radius) + stiffness * missing, law.area(a), stiffness, a)


def area_change(
    law: Contact, contact_radius: FloatArray, radius: FloatArray, slope: FloatArray
) -> FloatArray:
    """Relative change of the area at a given load by a slope g of the field, for contact radii a > 0.

    ``-2 (a D''/D' - 1) (g/D')^2``: zero for paraboloids, which only shift, and ``-2 (n - 2) (g/D')^2`` for
    powers n. It follows from the energy of an adhesive contact under a slope, with the moment
    ``4/3 a^3 - 2 a/D' sqrt(8 pi w a^3)``, as the derivative of the energy by w is the area. Resolved contacts
    on a slope agree within 1 % for powers 1.5 to 4 and for the sphere up to g/D' = 0.05.
    """
    own, before = (law.profile_slope(a, radius) for a in (contact_radius, (1.0 - STEP) * contact_radius))
    bend = np.log(own / before) / -math.log1p(-STEP)
    return np.asarray(-2.0 * (bend - 1.0) * (slope / own) ** 2)
