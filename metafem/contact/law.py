"""Protocol of contact laws."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol, cast, runtime_checkable

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps.shapes import Values
from metafem.errors import InvalidInput, NotConverged
from metafem.material import Material
from metafem.notes import Note

if TYPE_CHECKING:
    from metafem.surface import Surface

# Summits of caps that differ: R [mm], and the index of the cap of each asperity.
SUMMIT = np.dtype([("radius", np.float64), ("cap", np.int64)])

# Relative excess over the end of a law that is treated as rounding: a thousand times machine precision.
ROUNDING = 1e-12


@runtime_checkable
class Contact(Protocol):
    """Law of one axisymmetric contact for E* = 1, so that loads are P/E* [mm^2].

    A user-defined law derives from this class and defines the methods that have no body here. Pass it to a
    model: ``Independent(contact=MyLaw())``. Most methods take the contact radius a [mm] and the summit radius
    R [mm]. All methods are vectorised.

    Attributes
    ----------
    largest_order : int
        Highest order of the coupling with other contacts: 3 for a frictionless elastic contact without
        adhesion, whose load, second moment and indentation follow from one profile; 1 (point loads) for all
        other laws.
    similar : bool
        Whether the law is the same for all R when all lengths are divided by R.
    adhesive : bool
        Whether contacts adhere: the load is negative for some contact radii, and contacts jump.
    plastic : bool
        Whether contacts yield, so that their unloading follows another law.
    """

    largest_order: ClassVar[int] = 1
    similar: ClassVar[bool] = False
    adhesive: ClassVar[bool] = False
    plastic: ClassVar[bool] = False

    @property
    def scales_with_stress(self) -> bool:
        """Whether P/E* at a given indentation depends on E*, through an energy or a stress."""
        return self.largest_order == 1

    @property
    def power(self) -> float | None:
        """Exponent n of a power-law cap without adhesion: A ~ d^(2/n), P ~ d^(1 + 1/n); else None."""
        return None

    @property
    def without_adhesion(self) -> Contact:
        """The law without adhesion: the law itself if it has no adhesion."""
        return self

    def for_material(self, material: Material) -> Contact:
        """Return the law for a material; the law itself unless it has an energy or a stress."""
        return self

    def bound(self, surface: Surface) -> Contact:
        """Return the law for the material and the caps of a surface."""
        return self.for_material(surface.material)

    def summits(self, surface: Surface, radius: FloatArray | None = None) -> Any:
        """Return what the methods of a bound law take as `radius`, for all asperities of a surface.

        These are the radii of curvature of the summits [mm], (..., n), unless the law takes the caps by their
        own profiles. radius: R of the asperities (..., n) [mm]; default: the surface's.
        """
        return surface.cap.summit_radius(surface.radius if radius is None else radius)

    def breaks(self, radius: float) -> FloatArray:
        """Return the increasing contact radii [mm] between which the law is smooth, or an empty array."""
        return np.empty(0)

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Return the largest indentation [mm] for which the law is valid; infinite if there is no limit."""
        return np.full(np.shape(radius), math.inf)[()]

    def notes(self, indentation: FloatArray, radius: FloatArray) -> tuple[Note, ...]:
        """Return notes on the approximations of the law at the indentations (n,) [mm]."""
        return ()

    def contact_radius(self, indentation: Values, radius: Values) -> FloatArray:
        """Return the contact radius a [mm] at an indentation d [mm]; 0 for open contacts, d < 0."""
        ...

    def indentation(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the indentation d [mm]."""
        ...

    def load(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the rescaled load P/E* [mm^2]."""
        ...

    def area(self, contact_radius: Values) -> FloatArray:
        """Return the real contact area pi a^2 [mm^2]."""
        return np.asarray(math.pi * np.square(contact_radius))[()]

    def second_moment(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the integral of ``p rho^2`` over the contact over E* [mm^4]; nan for laws of order 1."""
        return np.full(np.shape(contact_radius), math.nan)[()]

    def stiffness(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the contact stiffness over E*, d(P/E*)/dd [mm]."""
        ...

    def area_slope(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the derivative dA/dd of the real contact area [mm]; 0 for an open contact."""
        ...

    def contacts(self, indentation: FloatArray, radius: FloatArray) -> Contacts:
        """Return the contacts at indentations [mm] without neighbours."""
        a = self.contact_radius(indentation, radius)
        stiffness = self.stiffness(a, radius)
        # first-order correction for rounding of a, because `load` loses digits near the equator of a sphere
        missing = np.where(a > 0.0, indentation - self.indentation(a, radius), 0.0)
        return Contacts(self.load(a, radius) + stiffness * missing, self.area(a), stiffness, a)

    def profile_slope(self, contact_radius: Values, radius: Values) -> FloatArray:
        """Return the slope dd/da of the indentation of an elastic cap [-], for a > 0."""
        a = np.asarray(contact_radius, dtype=np.float64)
        return np.asarray(2.0 * math.pi * a / self.area_slope(a, radius))


def checked_contact(contact: object) -> Contact:
    """Return `contact` if it is a contact law, else raise InvalidInput."""
    laws = "a contact law such as metafem.Hertz() or metafem.Elastic()"
    check.instance("contact", contact, Contact, laws)
    return cast("Contact", contact)


def material_of(law: Any) -> Material:
    """Return the material of a law; raise InvalidInput if none is set."""
    if law.material is None:
        raise InvalidInput(f"{law!r} has no material yet: use it in a model, or call for_material(material)")
    return cast("Material", law.material)


def sizes_of(summits: Any) -> FloatArray:
    """Return R [mm] of summits, which are numbers or `SUMMIT` records."""
    found = np.asarray(summits)
    return found["radius"] if found.dtype.names else np.asarray(found, dtype=np.float64)


def root(
    parts: Callable[[FloatArray], tuple[FloatArray, FloatArray]], target: FloatArray, start: FloatArray
) -> FloatArray:
    """Return the x > 0 at which the first value of parts(x) equals the target > 0.

    The second value of parts(x) is the derivative of the first with respect to ln x. Newton's method uses the
    logarithms of x and of the value, in which power laws are straight lines; it stays within a bracket.
    """
    x, low, high = start, np.zeros_like(target), np.full_like(target, math.inf)
    for _ in range(200):  # 3 to 8 are usual; each halves a bracket at least
        value, slope = parts(x)
        rising, tiny = (value > 0.0) & (slope > 0.0), value == 0.0  # by underflow
        low = np.where(tiny | (rising & (value <= target)), x, low)
        high = np.where(tiny | (rising & (value < target)), high, x)
        with np.errstate(all="ignore"):
            step = np.where(rising, np.log(target / value) * value / slope, np.where(tiny, 3.0, -1.0))
            new = x * np.exp(np.clip(step, -300.0, 300.0))  # neither 0 nor infinity
            middle = np.sqrt(low) * np.sqrt(high)
        outside = ~((new >= low) & (new <= high)) & (middle > 0.0) & np.isfinite(middle)
        new = np.where(outside, middle, new)
        if (np.abs(new - x) <= 1e-9 * x).all():  # the next step of Newton's method is below rounding
            return np.asarray(new)
        x = new
    raise NotConverged("no contact radius or indentation was found in 200 steps")


class Contacts(NamedTuple):
    """State of contacts at given indentations; all arrays have the same shape."""

    load: FloatArray  # P/E* [mm^2]
    area: FloatArray  # [mm^2]
    stiffness: FloatArray  # d(P/E*)/dd [mm]
    contact_radius: FloatArray  # [mm]


def area_change(
    law: Contact, contact_radius: FloatArray, radius: FloatArray, slope: FloatArray
) -> FloatArray:
    """Return the relative change of the area at given load due to a slope g of the displacement field.

    The change is ``-2 (a D''/D' - 1) (g/D')^2`` at contact radii a > 0. It vanishes for paraboloids, which
    only shift, and is ``-2 (n - 2) (g/D')^2`` for power-law caps. The formula follows from the energy of an
    adhesive contact on a slope, with the moment ``4/3 a^3 - 2 a/D' sqrt(8 pi w a^3)``: the derivative of the
    energy with respect to w is the area. Resolved contacts on a slope agree with the formula within 1 % for
    exponents n from 1.5 to 4 and for the sphere, up to g/D' = 0.05.
    """
    # D'' by a difference over a thousandth of the radius
    own, before = (law.profile_slope(a, radius) for a in (contact_radius, 0.999 * contact_radius))
    bend = np.log(own / before) / -math.log(0.999)
    return np.asarray(-2.0 * (bend - 1.0) * (slope / own) ** 2)
