"""Caps with any increasing profile, from a function or a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import scipy

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.caps.cap import Cap
from metafem.errors import InvalidInput, refuse_if

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

# Step of the finite difference for the slope at the end of a profile, relative to the extent.
TANGENT = 1e-6

# Distances from the axis, over the extent, at which the curvature 2 f/rho^2 of the summit of a function is
# computed, and the largest relative difference of the two values for a summit with a curvature.
NEAR_AXIS, SAME_CURVATURE = (2e-3, 1e-3), 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class Profile(Value, Cap):
    """Caps with any profile f(rho); all asperities have the same profile, whatever their R.

    Between the points of a table, f is a monotone cubic in rho^2.

    Parameters
    ----------
    profile : callable or array_like, (2, m)
        Depth f [mm] below the summit at the distance rho [mm] from the axis: a smooth, vectorised function,
        or a table with the rows rho and f that begins with (0, 0). f must increase with rho.
    extent : float, optional
        Largest rho at which the profile is used [mm], which is also the largest contact radius. It is
        required for a function; default for a table: the last rho.

    Raises
    ------
    InvalidInput
        If the profile does not increase, as that of a hollow cap, or a function has no extent.

    Examples
    --------
    >>> cap = Profile([[0.0, 0.1, 0.2, 0.3], [0.0, 0.01, 0.04, 0.09]])
    >>> cap.foot_radius(np.array([0.04]), np.array([0.5])), cap.summit_radius(np.array([0.5])).round(3)
    (array([0.2]), array([0.5]))
    """

    scaled: ClassVar[bool] = False

    profile: Callable | FloatArray  # type: ignore[type-arg]
    extent: float | None = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        if callable(self.profile):
            refuse_if(
                self.extent is None, "extent must be given with a function: the largest contact radius [mm]"
            )
            check.member(self, "extent", above=0.0)
            return
        table = check.array("profile", self.profile, shape=(2, None))
        for name, row in zip(("rho", "f"), table, strict=True):
            if len(row) < 3 or row[0] != 0.0 or not (np.diff(row) > 0.0).all():
                words = "must begin with 0 and increase over at least 3 points"
                raise InvalidInput(words, key=name, value=shown(row.tolist(), 80))
        refuse_if(
            self.extent is not None and self.extent != table[0, -1],
            f"extent = {self.extent} must be the last rho of the table, {table[0, -1]:g}",
        )
        object.__setattr__(self, "profile", table)
        object.__setattr__(self, "extent", float(table[0, -1]))

    def __repr__(self) -> str:
        """Return the call of the constructor, with the function's name or the number of points of a table."""
        if callable(self.profile):
            shape = getattr(self.profile, "__name__", type(self.profile).__name__)
        else:
            shape = f"<{self.profile.shape[1]} points>"
        return f"Profile({shape}, extent={self.extent:g})"

    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth [mm] at distances from the axis; beyond the extent, along the tangent."""
        rho, extent = np.asarray(rho, dtype=np.float64), float(self.extent)  # type: ignore[arg-type]
        before = (1.0 - TANGENT) * extent
        low, high = self.within(np.array([before, extent]))
        slope = (high - low) / (extent - before)
        inside = np.minimum(rho, extent)
        return np.asarray(self.within(inside.ravel()).reshape(rho.shape) + slope * (rho - inside))

    def within(self, rho: FloatArray) -> FloatArray:
        """Return the depth [mm] at distances up to the extent."""
        if callable(self.profile):
            return np.asarray(self.profile(rho), dtype=np.float64)
        return np.asarray(self.cubic(rho**2))

    @cached_property
    def cubic(self) -> PchipInterpolator:
        """Monotone cubic of rho^2 through the points of a table."""
        rho, depth = np.asarray(self.profile)
        return scipy.interpolate.PchipInterpolator(rho**2, depth, extrapolate=True)

    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return 1/f''(0) [mm]; raise InvalidInput if f'' has no finite, positive limit at the summit."""
        rho = np.array(NEAR_AXIS) * float(self.extent)  # type: ignore[arg-type]
        far, near = 2.0 * self.within(rho) / rho**2
        if not callable(self.profile):
            near = far = 2.0 * float(self.cubic(0.0, 1))
        if not (near > 0.0 and abs(far / near - 1.0) < SAME_CURVATURE):
            words = (
                "has no finite curvature at its summit, which this contact law needs; use contact = Elastic()"
            )
            raise InvalidInput(words, key="cap", value=repr(self))
        return np.full_like(radius, 1.0 / near)
