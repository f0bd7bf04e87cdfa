"""The protocol of contact laws."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from metafem._validate import FloatArray

Values = FloatArray | float


@runtime_checkable
class Contact(Protocol):
    """Law of one axisymmetric contact, for unit E*: loads are P/E* [mm^2].

    Any object with these methods is a contact law: ``Independent(contact=MyLaw())`` uses it.

    The contact radius a [mm] is the variable, R [mm] the radius of the summit; `curvature` [1/mm] is that of
    the displacement by other contacts, which adds ``curvature rho^2 / 2`` to the profile. All methods are
    vectorised.
    """

    def largest_indentation(self, radius: Values) -> FloatArray:
        """Largest indentation [mm] that the law describes; infinite where there is none."""
        ...

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
        """Real contact area [mm^2]."""
        ...

    def second_moment(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Second moment of the pressure over E*, the integral of ``p rho^2`` over the contact [mm^4]."""
        ...

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Derivative of the rescaled load by the indentation [mm]."""
        ...

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Derivative of the real contact area by the indentation [mm]; 0 for an open contact."""
        ...
