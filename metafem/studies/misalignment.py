"""The effect of a tilt between the plane and the surface on the friction law."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.notes import Note, information
from metafem.progress import doing
from metafem.studies.largest_tolerances import ALLOWED
from metafem.studies.sampling.batches import Execution, opened
from metafem.studies.sampling.dataset import QUANTILES, Variables, dataset, with_error
from metafem.studies.sampling.moments import Estimate
from metafem.studies.sampling.points import entropy
from metafem.studies.sampling.slope import Slope
from metafem.studies.sampling.store import inputs_hash
from metafem.studies.sampling.tilts import Tilts, both_signs, largest_angle, within
from metafem.surface import STEEPEST, Surface

if TYPE_CHECKING:
    import xarray as xr

# Equal steps up to the largest angle, as in the source paper: 2,001 angles with both signs.
STEPS = 1000

# Slopes along x and along y over the tangent of the angle.
DIRECTIONS = {"both": (1.0, 1.0), "x": (1.0, 0.0), "y": (0.0, 1.0)}

# With fewer angles, half as many do not show the error: with 2 it was up to ten times the estimate.
FEWEST_ANGLES = 20


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
    execution: Execution | None = None,
) -> xr.Dataset:
    """Return the scatter of the slope of the law if the plane is not parallel to the surface.

    A tilt changes the heights to ``h_i + x_i tan(angle_x) + y_i tan(angle_y)``, see `Surface.tilted`. The
    mean and the standard deviation at an angle are those over all angles between minus this angle and this
    angle, uniformly distributed, with a law that changes linearly between neighbouring angles. With many
    equal steps they are the mean and the standard deviation over all angles of the interval, as in Aymard et
    al., Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. S2 and supplementary text "Effect of a
    misalignment on the friction law".

    The largest angle at which the slope scatters by less than 1 % is found by separate searches, for any
    `angle`: usually three and at most twelve searches with 801 angles each.

    Parameters
    ----------
    surface : Surface
    angle : float or array_like, (k,)
        Largest angle [rad], reached in 1,000 equal steps, or increasing angles; positive and at most
        pi/4. Each is used with both signs, and the angle 0 in addition.
    model : Model, optional
        Default: `Independent()`.
    axes : "both", "x" or "y"
        Whether the surface is inclined by the angle along x and along y together, as in the source, only
        along x (`angle_x` of `Surface.tilted`), or only along y; default: "both".
    shuffles : int
        Number of random assignments of the asperities to the sites that are also studied; default: 0.
    load_range : (float, float), optional
        Rescaled loads P/E* between which a line is fitted [mm^2]. The source does not state its range.
        Default: 25 to 100 % of the load at which the plane reaches the lowest summit.
    rng : int or numpy.random.Generator
        Seed or generator of the shuffled placements; default: 0.
    execution : metafem.studies.Execution, optional
        Processes or cluster, and folder of a run that can be resumed; default: this process.

    Returns
    -------
    xarray.Dataset
        ``slope_mean`` and ``slope_sd`` [-] over ``placement`` ("as made", "shuffle 1", ...) and ``angle``
        [rad], and ``area_mean`` and ``area_sd`` [mm^2], as made, over ``angle`` and ``rescaled_load`` [mm^2].
        Their ``..._error`` is the difference from the result with half as many angles, the largest at the
        angle and its neighbours. With at least two shuffled placements, ``slope_sd_quantile`` over
        ``quantile`` (0.05, 0.5 and 0.95) and ``angle`` describes them; its error is the sampling error, which
        is too small at 0.05 and 0.95 for fewer than about 100 placements. ``nominal_slope`` and
        ``nominal_area`` are those without a tilt. ``largest_angle`` [rad] is the smallest angle at which
        `slope_sd` as made equals ``allowed_scatter``, 1 % of the nominal slope; it is infinite if there is
        none up to pi/4, and nan if none is found. ``failed`` is the number of laws without a solution; they
        are interpolated from those at the neighbouring angles.

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
    inputs = inputs_hash(task)
    with opened(execution, "misalignment", inputs) as compute:
        batches = list(compute(task, range(task.batches)))
        limit = largest_angle(compute, task)
    slopes = np.concatenate([batch["slope"] for batch in batches])
    failed = int(sum(batch["failed"].sum() for batch in batches))
    return _dataset(task, slopes, batches[0]["area"][0], failed, limit, inputs)


def _angles(angle: ArrayLike) -> FloatArray:
    """Return increasing positive angles (k,) [rad]."""
    if check.scalar(angle):
        largest = check.number("angle", angle, above=0.0, at_most=STEEPEST)
        return largest * np.arange(1, STEPS + 1) / STEPS
    angles = check.increasing("angle", check.array("angle", angle, shape=(None,)))
    check.number(f"angle[{len(angles) - 1}]", float(angles[-1]), at_most=STEEPEST)
    return angles


def _dataset(
    task: Tilts, slopes: FloatArray, area: FloatArray, failed: int, limit: Estimate, inputs: str
) -> xr.Dataset:
    """Return the dataset of slopes (p, a) and of the areas as made (a, k)."""
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
        quantile = _quantiles(by_slope[1].value[1:])
        variables |= with_error("slope_sd_quantile", ("quantile", "angle"), quantile)
        coordinates["quantile"] = list(QUANTILES)
    variables |= with_error("largest_angle", (), limit)
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
        "misalignment", variables, coordinates, model=task.model, load_range=task.fit.load_range,
        seed=task.seed, draws=slopes.size, inputs=inputs, notes=notes,
    ).assign_attrs(allowed_scatter=ALLOWED)  # fmt: skip


def _touches(task: Tilts) -> bool:
    """Whether the inclined base plane would touch at the largest angle and load."""
    surface, rise = task.surface, task.tilt[-1]
    tilted = surface.height + surface.position @ rise
    law = contact_of(task.model).for_material(surface.material)
    approach = Independent(contact=law).curve_of(tilted, surface.radius, task.fit.load[-1:]).approach[0]
    separation = float(tilted.max() - approach)  # at the origin, from the base plane
    block = surface.block
    sides = np.abs(surface.position).max(axis=0)
    if block is not None:
        sides = np.array([block.width, block.length]) / 2.0
    return not float(rise @ sides) < separation


def _quantiles(value: FloatArray) -> Estimate:
    """Return the quantiles of samples (m, ...) and their sampling errors.

    The error is half the distance of the quantiles at q - s and q + s with ``s = sqrt(q (1 - q) / m)``.
    """
    q = np.array(QUANTILES)
    s = np.sqrt(q * (1.0 - q) / len(value))
    low, high = (np.quantile(value, np.clip(q + sign * s, 0.0, 1.0), axis=0) for sign in (-1.0, 1.0))
    return Estimate(np.quantile(value, q, axis=0), (high - low) / 2.0)
