"""Hertz's law for the elastic contact of a paraboloid and a rigid plane."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.law import Contact, Values


@dataclass(frozen=True)
class Hertz(Contact):
    """Frictionless, non-adhesive elastic contact of a paraboloid of radius R and a rigid plane.

    With the contact radius a and the curvature ``1/R + k``, where k is due to the displacement by other
    contacts: ``d = a^2 (1/R + k)``, ``A = pi a^2``, ``P/E* = 4/3 a d``, ``dP/dd = 2 a E*``, and the second
    moment of the pressure is ``2/5 P a^2``. Lengths are in mm, P/E* in mm^2. The law is valid for a << R;
    with a fitted modulus its error is a few percent up to a/R = 0.5. Hertz, J. reine angew. Math. 92, 156
    (1882), doi:10.1515/crll.1882.92.156.

    Examples
    --------
    >>> d, R = np.array([-0.01, 0.0, 0.04]), np.array([0.5, 0.5, 1.0])
    >>> a = Hertz().contact_radius(d, R)
    >>> a, Hertz().load(a, R).round(6)
    (array([0. , 0. , 0.2]), array([0.      , 0.      , 0.010667]))
    """

    largest_order: ClassVar[int] = 3
    similar: ClassVar[bool] = True

    power: ClassVar[float] = 2.0

    def contact_radius(self, indentation: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the contact radius a = sqrt(d/(1/R + k)) [mm]; 0 where the contact is open."""
        sharpened = 1.0 + np.multiply(radius, curvature)
        return np.sqrt(np.multiply(radius, np.maximum(indentation, 0.0)) / sharpened)

    def indentation(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the indentation d = a^2 (1/R + k) [mm]."""
        return np.square(contact_radius) * (np.divide(1.0, radius) + curvature)

    def load(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the rescaled load P/E* = 4/3 a d [mm^2]."""
        return np.asarray(4.0 / 3.0 * contact_radius * self.indentation(contact_radius, radius, curvature))

    def second_moment(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the second moment of the pressure over E*, 2/5 P/E* a^2 [mm^4]."""
        return np.asarray(0.4 * np.square(contact_radius) * self.load(contact_radius, radius, curvature))

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return d(P/E*)/dd = 2 a [mm]."""
        return np.multiply(2.0, contact_radius)

    def depth_at(self, distance: Values, radius: Values) -> FloatArray:
        """Return the depth rho^2/(2 R) [mm] of the cap below its summit at a distance rho from the axis."""
        return np.divide(np.square(distance), np.multiply(2.0, radius))

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return dA/dd = pi R/(1 + R k) [mm]; 0 for an open contact."""
        return np.asarray(
            math.pi * np.greater(contact_radius, 0.0) / (np.divide(1.0, radius) + np.asarray(curvature))
        )

    def indentation_at_load(self, load: Values, radius: Values) -> FloatArray:
        """Return the indentation d = (3/4 P/E* / sqrt(R))^(2/3) [mm] of a contact without neighbours."""
        return np.asarray((0.75 * np.asarray(load) / np.sqrt(radius)) ** (2.0 / 3.0))


# Default contact law of all models.
PARABOLOID = Hertz()
