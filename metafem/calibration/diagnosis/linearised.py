"""The measured values around one part: residuals and their derivatives by the unknowns."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtr

from metafem._validate import FloatArray
from metafem.calibration.diagnosis.causes import Causes, Made
from metafem.calibration.diagnosis.observations import Observations
from metafem.calibration.diagnosis.sensitivities import Response, law_changes, response, with_adhesion
from metafem.models import Model
from metafem.models.model import contact_of
from metafem.surface import Friction

# Step of central differences over the prior standard deviation of a cause, or over that of the load.
STEP = 0.03

# Mean and standard deviation of the indentation above which a contact is detected, over (2b)^2/R with the
# error b of its boundary. A contact of the radius a, with the indentation a^2/R, is found open if the error
# of its area exceeds its area, with the probability N(-a/2b).
SEEN, SEEN_SD = 0.5, math.sqrt(1.25)

# Smallest standard deviation of an area over the largest area.
SMALLEST = 1e-12

# Largest change of an unknown, in prior standard deviations, for which differences are reused.
NEAR = 0.05

# Largest contact radius over the summit's at which the indentation of an overlooked area is taken: a
# spherical cap has no contact of its own radius.
WIDEST = 0.9

# Least area of a contact over the measured one at which the error of the area is taken: at half the radius.
LEAST_AREA = 0.25


@dataclass(frozen=True, eq=False)
class Linear:
    """Residuals over their standard deviations, their derivatives by z, and the gaps of open contacts."""

    residual: FloatArray  # (m,), measured minus computed: friction forces, total areas, areas of contacts
    gradient: FloatArray  # (m, p), derivatives of the computed values
    sd: FloatArray  # (m,), standard deviations, in the unit of each value
    indentation: FloatArray  # (c,), of the contacts found open, minus the smallest detected [mm]
    indentation_gradient: FloatArray  # (c, p)
    resolution: FloatArray  # (c,), standard deviation of the smallest detected indentation [mm]


@dataclass(frozen=True, eq=False)
class Scene:
    """The design, its unknown errors and its measured values under one model."""

    model: Model
    causes: Causes
    observed: Observations
    friction: Friction | None
    # the last differences by each kind of error, and where they were computed
    differences: dict[str, tuple[FloatArray, FloatArray]] = field(default_factory=dict, compare=False)

    def response(self, made: Made) -> Response:
        """Return the contacts of a part at its true loads."""
        return response(self.model, made, made.load / made.material.composite_modulus)

    def linear(self, z: FloatArray, covariance: FloatArray) -> Linear:
        """Return residuals and derivatives at unknowns of the mean z (p,) and a covariance (p, p)."""
        made = self.causes.made(z)
        found = self.response(made)
        return self._observed(made, found, self._derivatives(z, made, found), covariance)

    def _derivatives(self, z: FloatArray, made: Made, found: Response) -> FloatArray:
        """Return the derivatives of the areas of all contacts by z, (k, n, p)."""
        causes, design = self.causes, self.causes.surface
        k, n = found.area.shape
        result = np.zeros((k, n, causes.size))
        rows = np.arange(k)
        loads = result[:, :, causes.where["load"]]
        if not self.model.couples:
            modulus = made.material.composite_modulus
            by_load = found.by_load()
            loads[rows, :, rows] = by_load * (causes.load_sd / modulus)[:, None]
            x, y = made.position.T
            changes = {
                "angle_x": x * (1.0 + made.slope[0] ** 2),
                "angle_y": y * (1.0 + made.slope[1] ** 2),
                "height_scale": design.height,
            }
            for name, change in changes.items():
                if name in causes.sd:
                    result[:, :, causes.where[name].start] = causes.sd[name] * found.by_height(change)
            if "composite_modulus" in causes.sd:
                rate = found.by_law(found.by_modulus, -made.load / modulus) / made.stiffer
                result[:, :, causes.where["composite_modulus"].start] = causes.sd["composite_modulus"] * rate
            if "adhesion_root" in causes.sd:
                rate = found.by_law(found.by_adhesion) / made.adhesion
                result[:, :, causes.where["adhesion_root"].start] = causes.sd["adhesion_root"] * rate
        else:
            for name in causes.common:
                if name != "friction":
                    result[:, :, causes.where[name].start] = self._near_difference(z, name)
            loads[rows, :, rows] = self._near_difference(z, "load")
        if {"height", "position"} & causes.sd.keys():
            each = found.by_each_height()
            if "height" in causes.sd:
                result[:, :, causes.where["height"]] = causes.scale("height") * each
            if "position" in causes.sd:
                moved = causes.sd["position"] * each[..., None] * made.slope
                result[:, :, causes.where["position"]] = moved.reshape(k, n, 2 * n)
        if "radius" in causes.sd:
            result[:, :, causes.where["radius"]] = causes.sd["radius"] * found.by_each_radius()
        return result

    def _near_difference(self, z: FloatArray, name: str) -> FloatArray:
        """Return the difference of the areas by one kind of error, or an earlier one from near z."""
        if name not in self.differences or np.abs(z - self.differences[name][0]).max() > NEAR:
            self.differences[name] = z, self._difference(z, self.causes.where[name])
        return self.differences[name][1]

    def _difference(self, z: FloatArray, where: slice) -> FloatArray:
        """Return the central difference of the areas, with all numbers of one kind changed together."""
        sides = []
        for step in (STEP, -STEP):
            other = z.copy()
            other[where] += step
            sides.append(self.response(self.causes.made(other)).area)
        return np.asarray((sides[0] - sides[1]) / (2.0 * STEP))

    # the error of a value follows from the computed one: from the measured one, small values would have too
    # much weight
    def _observed(
        self, made: Made, found: Response, derivative: FloatArray, covariance: FloatArray
    ) -> Linear:
        """Return the residuals of all measured values and of the gaps of open contacts."""
        seen, causes = self.observed, self.causes
        total, by_total = _total(found.area, derivative, covariance)
        parts: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        errors = seen.measured.errors
        if seen.forces is not None and self.friction is not None:
            measured_force, force_sd = seen.forces
            nominal = self.friction.shear_strength * self.friction.area_ratio
            gradient = made.friction * nominal * by_total
            if "friction" in causes.sd:
                gradient[:, causes.where["friction"].start] += causes.sd["friction"] * nominal * total
            force = made.friction * nominal * total
            sd = force_sd * _ratio(errors.of_friction_force, force, measured_force)
            parts.append((measured_force - force, gradient, sd))
        if seen.totals is not None:
            measured_total, total_sd = seen.totals
            sd = total_sd * _ratio(errors.of_area, total, measured_total)
            parts.append((measured_total - total, by_total, sd))
        if len(seen.area):
            computed = found.area[seen.row, seen.site]
            least = np.maximum(LEAST_AREA * seen.area, math.pi * seen.boundary**2)
            sd = 2.0 * seen.boundary * np.sqrt(math.pi * np.maximum(computed, least))
            parts.append((seen.area - computed, derivative[seen.row, seen.site], sd))
        residual, gradient, sd = (np.concatenate(values) for values in zip(*parts, strict=True))
        rate = found.area_rate[seen.open_row, seen.open_site]
        by_indentation = derivative[seen.open_row, seen.open_site] / rate[:, None]
        if "radius" in causes.sd:  # the latent area is pi R d: that of the gap
            place = causes.where["radius"].start + seen.open_site
            own = found.area_by_radius[seen.open_row, seen.open_site] / rate
            by_indentation[np.arange(len(rate)), place] -= causes.sd["radius"] * own
        boundary = float(np.median(seen.boundary)) if len(seen.boundary) else 0.0
        seen_from, resolution, *smallest = self._smallest(boundary, made)
        for name, change, least, factor in (
            ("composite_modulus", found.by_modulus, smallest[0], made.stiffer),
            ("adhesion_root", found.by_adhesion, smallest[1], made.adhesion),
        ):
            if name in causes.sd:
                shift = (change.indentation[seen.open_row, seen.open_site] - least) / factor
                by_indentation[:, causes.where[name].start] += causes.sd[name] * shift
        return Linear(
            residual / sd,
            gradient / sd[:, None],
            sd,
            found.indentation[seen.open_row, seen.open_site] - seen_from,
            by_indentation,
            resolution,
        )

    def _smallest(self, boundary: float, made: Made) -> tuple[FloatArray, ...]:
        """Return the smallest indentation (c,) at which a contact is detected [mm], and its error.

        The other two values are its derivatives by log E* and by log sqrt(w).

        With the error b of the boundary it is about b^2/(2 R); if a larger area may be overlooked, it is the
        indentation of that area, with the error 2 a b/R from the error of the contact radius a.
        """
        seen, radius = self.observed, self.causes.surface.radius[self.observed.open_site]
        least = (2.0 * boundary) ** 2 / radius
        contact = with_adhesion(contact_of(self.model), made.adhesion)
        size = np.sqrt(seen.overlooked / math.pi)
        size = np.where(size > 2.0 * boundary, np.minimum(size, WIDEST * radius), 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = contact.for_material(made.material).indentation(size, radius)
        # an adhesive contact has at least the area at zero indentation
        wide = (size > 0.0) & (depth > 0.0)
        by_modulus, by_adhesion = law_changes(contact, made.material, np.where(wide, size, 0.0), radius)
        return (
            np.where(size > 0.0, np.maximum(depth, 0.0), SEEN * least),
            np.where(size > 0.0, 2.0 * size * boundary / radius, SEEN_SD * least),
            by_modulus.indentation,
            by_adhesion.indentation,
        )


def _total(area: FloatArray, derivative: FloatArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the total areas (k,) and their derivatives (k, p), as means over the covariance of z.

    The mean of max(A, 0) over a normal distribution of A, with the standard deviation s and u = A/s, is
    ``A N(u) + s n(u)``, with the derivative N(u): it has no kink where a contact opens.
    """
    rows = derivative.reshape(-1, derivative.shape[-1])
    variance = np.einsum("mp,mp->m", rows @ covariance, rows).reshape(area.shape)
    sd = np.sqrt(np.maximum(variance, 0.0))
    u = area / np.maximum(sd, SMALLEST * np.abs(area).max())
    closed = ndtr(u)
    mean = area * closed + sd * np.exp(-0.5 * u**2) / math.sqrt(2.0 * math.pi)
    return mean.sum(axis=1), (closed[:, None, :] @ derivative)[:, 0]


def _ratio(
    error: Callable[[FloatArray], FloatArray], computed: FloatArray, measured: FloatArray
) -> FloatArray:
    """Return the error of the computed values over that of the measured ones, limited to 0.5 to 2."""
    of_measured = error(measured)
    ratio = np.divide(error(computed), of_measured, np.ones_like(computed), where=of_measured > 0.0)
    return np.asarray(np.clip(ratio, 0.5, 2.0))
