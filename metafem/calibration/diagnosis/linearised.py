"""Linearised model of the measured values: residuals and their derivatives with respect to the unknowns."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.calibration.diagnosis.causes import Causes, Made
from metafem.calibration.diagnosis.sensitivities import Response, law_changes, response, with_adhesion
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.contact import Contact
from metafem.models import Model
from metafem.models.model import contact_of
from metafem.surface import Friction

# Step of central differences, over the prior standard deviation of an error or of a load.
STEP = 0.03

# A contact of radius a is found open if the error of its area exceeds its area, which has the probability
# N(-a/2b) with the error b of the boundary. The smallest contact radius that is detected is therefore 0 in
# half of the cases, and 2b times the absolute value of a standard normal number in the other half: positive
# nodes of this number and their weights, which are exact for paraboloids.
NORMAL, WEIGHT = (half[16:] for half in np.polynomial.hermite_e.hermegauss(32))
WEIGHT /= math.sqrt(2.0 * math.pi)

# Largest change of an unknown, in prior standard deviations, up to which earlier differences are reused.
NEAR = 0.05

# The indentation of an overlooked area is computed up to this contact radius, over R and over the largest
# contact radius of the cap. The contact radius of a spherical cap cannot reach the radius of the cap.
WIDEST = 0.9

# Smallest computed area, over the measured area, at which the error of the area is computed. It corresponds
# to half the contact radius.
LEAST_AREA = 0.25


@dataclass(frozen=True, eq=False)
class Linear:
    """Normalised residuals, derivatives with respect to z, and indentations of open contacts."""

    residual: FloatArray  # (m,), measured minus computed friction forces, total areas, contact areas
    gradient: FloatArray  # (m, p), derivatives of the computed values
    sd: FloatArray  # (m,), standard deviations in the units of the values
    indentation: FloatArray  # (c,), of contacts found open, minus the smallest detectable [mm]
    indentation_gradient: FloatArray  # (c, p)
    resolution: FloatArray  # (c,), standard deviation of the smallest detectable indentation [mm]


@dataclass(frozen=True, eq=False)
class Scene:
    """The design, its unknown errors, the measured values and one model."""

    model: Model
    causes: Causes
    measured: MeasuredLaw
    friction: Friction | None
    # for each kind of error, the z of the last computed difference and the difference
    differences: dict[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict, compare=False)

    @property
    def totals(self) -> list[str]:
        """Names of the measured totals; the total area is omitted if the areas of the contacts are known."""
        names = ("friction_force", "area") if self.measured.asperity_area is None else ("friction_force",)
        return [name for name in names if getattr(self.measured, name) is not None]

    @cached_property
    def single(self) -> tuple[FloatArray, FloatArray, IntArray]:
        """Contact areas (k, m), their standard deviations, and the numbers of their asperities (m,)."""
        law, none = self.measured, np.zeros((len(self.measured.load), 0))
        if law.asperity_area is None or law.asperity_area_sd is None or law.site is None:
            return none, none, np.zeros(0, dtype=np.int64)
        return law.asperity_area, law.asperity_area_sd, law.site

    @cached_property
    def closed(self) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
        """Numbers of load and asperity of each closed contact, its area [mm^2] and boundary error [mm]."""
        area, sd, site = self.single
        row, column = np.nonzero(area > 0.0)
        found = area[row, column]
        return row, site[column], found, sd[row, column] / (2.0 * np.sqrt(math.pi * found))

    @cached_property
    def opened(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Largest load with the contact open (its number), asperity, and overlooked area [mm^2], (c,) each.

        The overlooked area is the largest that the image may not show. At smaller loads the contact is open,
        too. If the overlooked area is 0, the boundary error determines which contacts are overlooked.
        """
        area, sd, site = self.single
        column = np.flatnonzero((area <= 0.0).any(axis=0))
        last = len(area) - 1 - np.argmax(area[::-1, column] <= 0.0, axis=0)
        return last, site[column], sd[last, column]

    def response(self, made: Made) -> Response:
        """Return the contacts of a part at its true loads."""
        return response(self.model, made, made.load / made.surface.material.composite_modulus)

    def linear(self, z: FloatArray, covariance: FloatArray) -> Linear:
        """Return residuals and derivatives for unknowns with the mean z (p,) and a covariance (p, p)."""
        made = self.causes.made(z)
        found = self.response(made)
        return self._observed(made, found, self._derivatives(z, made, found), covariance)

    def _derivatives(self, z: FloatArray, made: Made, found: Response) -> FloatArray:
        """Return the derivatives of the areas of all contacts with respect to z, (k, n, p)."""
        causes = self.causes
        if self.model.couples:
            names = [name for name in (*causes.common, "load") if name != "friction"]
            rates = {name: self._near_difference(z, name) for name in names}
        else:
            rates = self._rates(made, found)
        k, n = found.area.shape
        result, rows = np.zeros((k, n, causes.size)), np.arange(k)
        result[:, :, causes.where["load"]][rows, :, rows] = rates.pop("load")
        for name, rate in rates.items():
            result[:, :, causes.where[name].start] = rate
        each = found.by_each_height()
        if "height" in causes.sd:
            result[:, :, causes.where["height"]] = causes.scale("height") * each
        if "position" in causes.sd:
            moved = causes.sd["position"] * each[..., None] * made.slope
            result[:, :, causes.where["position"]] = moved.reshape(k, n, 2 * n)
        if "radius" in causes.sd:
            result[:, :, causes.where["radius"]] = causes.sd["radius"] * found.by_each_radius()
        return result

    def _rates(self, made: Made, found: Response) -> dict[str, FloatArray]:
        """Return the derivatives (k, n) of the areas of independent contacts by common errors and loads."""
        causes, modulus = self.causes, made.surface.material.composite_modulus
        along = made.surface.position * (1.0 + made.slope**2)
        by_modulus = found.by_law(found.by_modulus, -made.load / modulus)
        rates = {
            "angle_x": found.by_height(along[:, 0]),
            "angle_y": found.by_height(along[:, 1]),
            "height_scale": found.by_height(causes.surface.height),
            "composite_modulus": by_modulus / made.factor["composite_modulus"],
            "adhesion_root": found.by_law(found.by_adhesion) / made.factor["adhesion_root"],
        }
        scaled = {name: causes.sd[name] * rate for name, rate in rates.items() if name in causes.sd}
        return scaled | {"load": found.by_load() * (causes.load_sd / modulus)[:, None]}

    def _near_difference(self, z: FloatArray, name: str) -> FloatArray:
        """Return the difference quotient of the areas for one kind of error (k, n), at z or near z."""
        if name not in self.differences or np.abs(z - self.differences[name][0]).max() > NEAR:
            self.differences[name] = z, self._difference(z, self.causes.where[name])
        return self.differences[name][1]

    def _difference(self, z: FloatArray, where: slice) -> FloatArray:
        """Return the difference quotient of the areas (k, n); the entries `where` of z change together."""
        sides = []
        for step in (STEP, -STEP):
            other = z.copy()
            other[where] += step
            sides.append(self.response(self.causes.made(other)).area)
        return np.asarray((sides[0] - sides[1]) / (2.0 * STEP))

    # The standard deviation of a value is evaluated at the computed value. If it were evaluated at the
    # measured value, values that are too small by chance would have too much weight.
    def _observed(
        self, made: Made, found: Response, derivative: FloatArray, covariance: FloatArray
    ) -> Linear:
        """Return the residuals of all measured values and the gaps of open contacts."""
        law, causes = self.measured, self.causes
        total, by_total = _total(found, derivative, covariance)
        row, site, area, boundary = self.closed
        parts: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        for name in self.totals:
            computed, gradient = total, by_total
            error: Callable[[FloatArray], FloatArray] = law.errors.of_area
            if name == "friction_force" and self.friction is not None:
                nominal = self.friction.stress
                stress, error = made.factor["friction"] * nominal, law.errors.of_friction_force
                computed, gradient = stress * total, stress * by_total
                if "friction" in causes.sd:
                    gradient[:, causes.where["friction"].start] += causes.sd["friction"] * nominal * total
            measured = getattr(law, name)
            sd = getattr(law, f"{name}_sd") * _ratio(error, computed, measured)
            parts.append((measured - computed, gradient, sd))
        if len(area):
            computed = found.area[row, site]
            least = np.maximum(LEAST_AREA * area, math.pi * boundary**2)
            sd = 2.0 * boundary * np.sqrt(math.pi * np.maximum(computed, least))
            parts.append((area - computed, derivative[row, site], sd))
        residual, gradient, sd = (np.concatenate(values) for values in zip(*parts, strict=True))
        return Linear(residual / sd, gradient / sd[:, None], sd, *self._gaps(made, found, derivative))

    def _gaps(self, made: Made, found: Response, derivative: FloatArray) -> tuple[FloatArray, ...]:
        """Return indentations (c,) of open contacts minus the smallest detectable [mm], and its error [mm].

        The second returned value, between the two, is the derivative of the indentations with respect to z,
        (c, p).
        """
        causes, (row, site, _) = self.causes, self.opened
        rate = found.area_rate[row, site]
        gradient = derivative[row, site] / rate[:, None]
        if "radius" in causes.sd:  # the area of an open contact is r(R) d; remove its derivative by R
            own = found.area_by_radius[row, site] / rate
            gradient[np.arange(len(rate)), causes.where["radius"].start + site] -= causes.sd["radius"] * own
        least, resolution, *smallest = self._smallest(made)
        changes = {"composite_modulus": found.by_modulus, "adhesion_root": found.by_adhesion}
        for (name, (change, _)), of_least in zip(changes.items(), smallest, strict=True):
            if name in causes.sd:
                shift = (change[row, site] - of_least) / made.factor[name]
                gradient[:, causes.where[name].start] += causes.sd[name] * shift
        return found.indentation[row, site] - least, gradient, resolution

    def _smallest(self, made: Made) -> tuple[FloatArray, ...]:
        """Return the smallest indentation at which a contact is detected, and its error, (c,) [mm].

        The other two values are the derivatives of this indentation with respect to log E* and log sqrt(w).

        If the boundary error b limits the detection, both are the mean and the standard deviation of the
        indentation at the smallest detectable contact radius. If a larger area may be overlooked, the result
        is the indentation of that area, and its error D'(a) b follows from the error b of the contact radius
        a.
        """
        _, site, overlooked = self.opened
        boundary = float(np.median(self.closed[-1])) if len(self.closed[-1]) else 0.0
        part = self.causes.surface.replaced(material=made.surface.material)
        contact = with_adhesion(contact_of(self.model), made.factor["adhesion_root"])
        summits, law = contact.summits(part)[site], contact.bound(part)
        cap = law.without_adhesion
        most = np.minimum(WIDEST * part.radius[site], WIDEST * _widest(cap, summits))
        size = np.sqrt(overlooked / math.pi)
        size = np.where(size > 2.0 * boundary, np.minimum(size, most), 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth, slope = law.indentation(size, summits), cap.profile_slope(size, summits)
        least = cap.indentation(np.minimum(2.0 * boundary * NORMAL[:, None], most), summits)
        mean = WEIGHT @ least
        # an adhesive contact has at least the area at zero indentation
        wide = np.where((size > 0.0) & (depth > 0.0), size, 0.0)
        return (
            np.where(size > 0.0, np.maximum(depth, 0.0), mean),
            np.where(size > 0.0, slope * boundary, np.sqrt(WEIGHT @ least**2 - mean**2)),
            *(indentation for indentation, _ in law_changes(contact, part, wide, summits)),
        )


def _widest(cap: Contact, summits: Any) -> FloatArray:
    """Return the largest contact radii [mm] that a cap describes; infinite if there is no limit."""
    most = cap.largest_indentation(summits)
    limited = np.isfinite(most)
    return np.where(limited, cap.contact_radius(np.where(limited, most, 0.0), summits), math.inf)


def _total(found: Response, derivative: FloatArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the mean total areas (k,) and their derivatives (k, p) if z has this covariance.

    The mean area is smooth where a contact opens.
    """
    rows = derivative.reshape(-1, derivative.shape[-1])
    variance = np.einsum("mp,mp->m", rows @ covariance, rows).reshape(found.area.shape)
    mean, rate = found.mean_areas(np.sqrt(np.maximum(variance, 0.0)) / found.area_rate)
    return mean.sum(axis=1), ((rate / found.area_rate)[:, None, :] @ derivative)[:, 0]


def _ratio(
    error: Callable[[FloatArray], FloatArray], computed: FloatArray, measured: FloatArray
) -> FloatArray:
    """Return the error at the computed values over the error at the measured values, limited to 0.5 to 2."""
    of_measured = error(measured)
    ratio = np.divide(error(computed), of_measured, np.ones_like(computed), where=of_measured > 0.0)
    return np.asarray(np.clip(ratio, 0.5, 2.0))
