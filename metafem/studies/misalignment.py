"""The effect of a tilt between the plane and the surface on the friction law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.caps import Caps
from metafem.errors import NotConverged, refuse_if
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.notes import Note, information
from metafem.progress import doing
from metafem.studies.sampling.batches import computed
from metafem.studies.sampling.dataset import QUANTILES, Estimate, Variables, dataset, with_error
from metafem.studies.sampling.points import entropy
from metafem.studies.sampling.slope import Slope
from metafem.surface import STEEPEST, Surface

if TYPE_CHECKING:
    import xarray as xr

# Number of equal steps up to the largest angle. As in the source paper, both signs and 0 give 2,001 angles.
STEPS = 1000

# Slopes of the tilt along x and along y, divided by the tangent of the angle.
DIRECTIONS = {"both": (1.0, 1.0), "x": (1.0, 0.0), "y": (0.0, 1.0)}

# With fewer angles, a comparison with half as many underestimates the error: with 2 angles, the error was up
# to ten times the estimate.
FEWEST_ANGLES = 20

# Number of shuffled placements in a batch. A placement of 64 independent asperities at 2,001 angles and 20
# loads takes a quarter of a second. Coupled asperities take a hundred times as long; their batches have a
# single placement.
AT_ONCE = 10

# Largest number of heights that are solved at once; they take 32 MiB.
MOST_HEIGHTS = 2**22

# The error at an angle is the largest change at this angle and this number of neighbours on each side.
NEIGHBOURS = 2


@doing("tilting the surface")
def misalignment(
    surface: Surface,
    angle: ArrayLike,
    *,
    model: Model | None = None,
    axes: Literal["both", "x", "y"] = "both",
    shuffles: int = 0,
    load_range: tuple[float, float] | None = None,
    rng: Any = 0,
) -> xr.Dataset:
    """Return mean and scatter of the friction law if the plane is not parallel to the surface.

    A tilt changes the heights to ``h_i + x_i tan(angle_x) + y_i tan(angle_y)``, see `Surface.tilted`. For
    each angle, mean and standard deviation are computed for a tilt that is uniformly distributed between
    minus this angle and this angle. The law is interpolated linearly between neighbouring angles. With many
    equal steps, the results are the mean and the standard deviation over all angles of the interval, as in
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. S2 and supplementary text
    "Effect of a misalignment on the friction law".

    The placements are computed as `joblib.parallel_config` says.

    Parameters
    ----------
    surface : Surface
    angle : float or array_like, (k,)
        One angle [rad], which is reached in 1,000 equal steps, or increasing angles; positive and at most
        pi/4. All angles are used with both signs, together with the angle 0.
    model : Model, optional
        Default: `Independent()`.
    axes : "both", "x" or "y"
        Direction of the tilt: along x and along y by the same angle, as in the source; only along x
        (`angle_x` of `Surface.tilted`); or only along y. Default: "both".
    shuffles : int
        Number of random assignments of the asperities to the sites that are also studied; default: 0.
    load_range : (float, float), optional
        Rescaled loads P/E* between which a line is fitted [mm^2]. The source does not state its range.
        Default: 25 to 100 % of the load at which the plane reaches the lowest summit.
    rng : int or numpy.random.Generator
        Seed or generator of the shuffled placements; default: 0.

    Returns
    -------
    xarray.Dataset
        ``slope_mean`` and ``slope_sd`` [-] over ``placement`` ("as made", "shuffle 1", ...) and ``angle``
        [rad], and ``area_mean`` and ``area_sd`` [mm^2], as made, over ``angle`` and ``rescaled_load`` [mm^2].
        Their ``..._error`` is the change if only half of the angles are used, the largest change at the angle
        and its neighbours. With at least two shuffled placements, ``slope_sd_quantile`` over ``quantile``
        (0.05, 0.5 and 0.95) and ``angle`` gives the quantiles of their `slope_sd`. ``nominal_slope`` and
        ``nominal_area`` are the values without a tilt. ``failed`` is the number of laws without a solution;
        these laws are interpolated between the neighbouring angles.

    Raises
    ------
    InvalidInput
        For angles that are not positive, do not increase or exceed pi/4.
    NotConverged
        If fewer than two angles of a placement have a solution.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(
    ...     [[0.1, 0.12], [0.11, 0.13]], (2, 2), radius=0.526, material=mf.Material(1.36)
    ... )
    >>> found = misalignment(surface, [0.0005, 0.001], shuffles=3)
    >>> dict(found.slope_sd.sizes), found.slope_sd[0].round(3).values
    ({'placement': 4, 'angle': 2}, array([0.025, 0.065]))
    """
    words = f"must be one of {', '.join(map(repr, DIRECTIONS))}"
    surface.refuse_tilt()
    refuse_if(axes not in DIRECTIONS, words, key="axes", value=repr(axes))
    signed = both_signs(_angles(angle))
    used = checked_model(Independent() if model is None else model)
    fit = Slope.of(surface, load_range, used)
    task = Tilts(
        surface,
        used,
        np.array(DIRECTIONS[axes]),
        signed,
        fit,
        check.integer("shuffles", shuffles, at_least=0),
        entropy(rng),
    )
    batches = list(computed(task, range(task.batches)))
    slopes = np.concatenate([batch["slope"] for batch in batches])
    failed = int(sum(batch["failed"].sum() for batch in batches))
    return _dataset(task, slopes, batches[0]["area"][0], failed)


def _angles(angle: ArrayLike) -> FloatArray:
    """Return increasing positive angles (k,) [rad]."""
    if check.scalar(angle):
        largest = check.number("angle", angle, above=0.0, at_most=STEEPEST)
        return largest * np.arange(1, STEPS + 1) / STEPS
    angles = check.increasing("angle", check.array("angle", angle, shape=(None,)))
    check.number(f"angle[{len(angles) - 1}]", float(angles[-1]), at_most=STEEPEST)
    return angles


def _dataset(task: Tilts, slopes: FloatArray, area: FloatArray, failed: int) -> xr.Dataset:
    """Return the dataset, from the slopes (p, a) of all placements and the areas (a, k) as made [mm^2]."""
    middle = len(task.angle) // 2
    by_slope, by_area = within(task.angle, slopes), within(task.angle, area.T)
    variables: Variables = {}
    for moment, slope, law in zip(("mean", "sd"), by_slope, by_area, strict=True):
        variables |= with_error(f"slope_{moment}", ("placement", "angle"), slope)
        variables |= with_error(f"area_{moment}", ("angle", "rescaled_load"), (law.value.T, law.error.T))
    coordinates: dict[str, Any] = {
        "placement": ["as made", *(f"shuffle {k}" for k in range(1, len(slopes)))],
        "angle": task.angle[middle + 1 :],
        "rescaled_load": task.fit.load,
    }
    if len(slopes) > 2:
        found = np.quantile(by_slope[1].value[1:], QUANTILES, axis=0)
        variables["slope_sd_quantile"] = ("quantile", "angle"), found
        coordinates["quantile"] = list(QUANTILES)
    variables["nominal_slope"] = (), slopes[0, middle]
    variables["nominal_area"] = ("rescaled_load",), area[middle]
    variables["failed"] = (), failed
    notes = [information("the errors of means and deviations are their changes with half as many angles")]
    if middle < FEWEST_ANGLES:
        few = f"errors estimated from {middle} angles can be several times too small; give one angle"
        notes.append(Note(f"{few}, which is reached in {STEPS} steps, or at least {FEWEST_ANGLES}"))
    if _touches(task):
        at = f"{task.angle[-1]:.3g} rad and a load of {task.fit.load[-1]:.3g} mm^2"
        words = "the edge of the base plane would touch; the laws have no such contact"
        notes.append(Note(f"at {at} {words}"))
    if failed:
        notes.append(Note(f"{failed} laws have no solution; they are interpolated from neighbouring angles"))
    return dataset(
        "misalignment", variables, coordinates, model=task.model, slope=task.fit,
        seed=task.seed, draws=slopes.size, notes=notes,
    )  # fmt: skip


def _touches(task: Tilts) -> bool:
    """Return whether the tilted base plane would touch the plane at the largest angle and load."""
    surface, rise = task.surface, task.tilt[-1]
    tilted = surface.height + surface.position @ rise
    law = contact_of(task.model).bound(surface)
    summits = law.summits(surface)
    approach = Independent(contact=law).curve_of(tilted, summits, task.fit.load[-1:]).approach[0]
    separation = float(tilted.max() - approach)  # from the base plane at the origin
    block = surface.block
    sides = np.abs(surface.position).max(axis=0)
    if block is not None:
        sides = np.array([block.width, block.length]) / 2.0
    return not float(rise @ sides) < separation


@dataclass(frozen=True, eq=False)
class Tilts:
    """Laws of a surface at all angles, as made (batch 0) and for shuffled placements (further batches)."""

    surface: Surface
    model: Model
    direction: FloatArray  # (2,), slopes along x and along y, divided by the tangent of the angle
    angle: FloatArray  # (a,) [rad]
    fit: Slope
    shuffles: int
    seed: int

    @property
    def tilt(self) -> FloatArray:
        """Slopes along x and along y [-], (a, 2)."""
        return np.outer(np.tan(self.angle), self.direction)

    @property
    def at_once(self) -> int:
        """Number of shuffled placements in a batch."""
        return 1 if self.model.couples else AT_ONCE

    @property
    def batches(self) -> int:
        """Number of batches."""
        return 1 + -(-self.shuffles // self.at_once)

    def __call__(self, batch: int) -> dict[str, FloatArray]:
        """Return the slopes (p, a) of the placements of a batch, and the areas of batch 0, (1, a, k)."""
        orders = [np.arange(self.surface.count)]
        if batch > 0:
            placements = range(self.at_once * (batch - 1), min(self.at_once * batch, self.shuffles))
            seeds = [np.random.SeedSequence(self.seed, spawn_key=(k,)) for k in placements]
            orders = [np.random.default_rng(seed).permutation(self.surface.count) for seed in seeds]
        found = [self._law(order) for order in orders]
        areas = np.array([area for area, _ in found])
        return {
            # no matrix product: its last bits would depend on the number of threads
            "slope": np.einsum("pak,k->pa", areas, self.fit.weight),
            "area": areas if batch == 0 else areas[:0],
            "failed": np.array([failed for _, failed in found]),
        }

    def _law(self, order: IntArray) -> tuple[FloatArray, int]:
        """Return A0 (a, k), interpolated where there is no solution, and the number of interpolated laws."""
        area = self._areas(order)
        solved = np.isfinite(area).all(axis=1)
        if solved.sum() < 2:
            raise NotConverged("fewer than two angles of a placement have a solution")
        if not solved.all():
            for column in area.T:
                column[~solved] = np.interp(self.angle[~solved], self.angle[solved], column[solved])
        return area, int((~solved).sum())

    def _areas(self, order: IntArray) -> FloatArray:
        surface = self.surface
        rise = self.tilt @ surface.position.T
        if isinstance(surface.cap, Caps):  # also the caps are shuffled
            surface, order = surface.only(order, position=surface.position), np.arange(surface.count)
        radius = None if np.ptp(surface.radius) == 0.0 else surface.radius[order]
        rows = max(1, MOST_HEIGHTS // surface.count)
        parts = []
        for start in range(0, len(rise), rows):
            height = surface.height[order] + rise[start : start + rows]
            radii = None if radius is None else np.broadcast_to(radius, height.shape)
            parts.append(self.model.areas(surface, self.fit.load, height, radii))
        return np.concatenate(parts)


def both_signs(angle: FloatArray) -> FloatArray:
    """Return increasing angles with both signs and 0, (2 k + 1,)."""
    return np.concatenate([-angle[::-1], [0.0], angle])


def within(angle: FloatArray, value: FloatArray) -> tuple[Estimate, Estimate]:
    """Return mean and standard deviation over [-angle, angle], each with its error, (..., k).

    angle: (2 k + 1,), increasing and symmetric about 0; value: (..., 2 k + 1), at these angles. The error is
    the change if only every second angle of the interval is used, beginning at its ends.
    """
    middle = len(angle) // 2
    fine = _uniform(angle, value)
    coarse = tuple(np.empty_like(part) for part in fine)
    for odd in (0, 1):
        # every second angle, with 0 (odd = 0) or without 0 (odd = 1)
        some = slice((middle - odd) % 2, None, 2)
        for whole, part in zip(coarse, _uniform(angle[some], value[..., some]), strict=True):
            whole[..., 1 - odd :: 2] = part
    mean, sd = (
        Estimate(one, _largest_nearby(np.abs(one - other))) for one, other in zip(fine, coarse, strict=True)
    )
    return mean, sd


def _largest_nearby(change: FloatArray) -> FloatArray:
    """Return the largest change among each angle and its neighbours: a single change may be 0 by chance."""
    padded = np.pad(change, [(0, 0)] * (change.ndim - 1) + [(NEIGHBOURS, NEIGHBOURS)], mode="edge")
    nearby = np.lib.stride_tricks.sliding_window_view(padded, 2 * NEIGHBOURS + 1, axis=-1)
    return np.asarray(nearby.max(axis=-1))


def _uniform(angle: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation over [-angle, angle] of values interpolated between angles."""
    centre = value[..., [len(angle) // 2]]  # subtracted, so that small deviations keep their digits
    left, right = value[..., :-1] - centre, value[..., 1:] - centre
    width = np.diff(angle)
    count = len(angle) // 2
    moments = []
    for integral in (width * (left + right) / 2.0, width * (left**2 + left * right + right**2) / 3.0):
        both = (integral + integral[..., ::-1])[..., -count:]
        if len(width) % 2:
            both[..., 0] /= 2.0  # the interval that contains 0 was counted twice
        moments.append(np.cumsum(both, axis=-1) / (2.0 * angle[-count:]))
    mean, square = moments
    return mean + centre, np.sqrt(np.maximum(square - mean**2, 0.0))
