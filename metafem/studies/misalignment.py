"""The effect of a tilt between the plane and the surface on the friction law."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.notes import Note
from metafem.progress import doing
from metafem.studies.dataset import QUANTILES, Variables, dataset
from metafem.studies.draws import computed, generator_of, seed_of
from metafem.studies.slope import range_note, slope, slope_loads
from metafem.surface import STEEPEST, Surface

if TYPE_CHECKING:
    import xarray as xr

# Number of equal steps up to the largest angle. As in the source paper, both signs and 0 give 2,001 angles.
STEPS = 1000


@doing("tilting the surface")
def misalignment(
    surface: Surface,
    angle: ArrayLike,
    *,
    model: Model | None = None,
    assignments: int = 0,
    load_range: tuple[float, float] | None = None,
    rng: Any = 0,
) -> xr.Dataset:
    """Return mean and scatter of the friction law if the plane is not parallel to the surface.

    A tilt by one angle along x and along y changes the heights to ``h_i + (x_i + y_i) tan(angle)``. For each
    angle, mean and standard deviation are taken over all tilts from minus this angle to this angle, as in
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. S2 and supplementary text
    "Effect of a misalignment on the friction law". The law is linear between neighbouring angles. The
    assignments are computed as `joblib.parallel_config` says.

    Parameters
    ----------
    surface : Surface
    angle : float or array_like, (k,)
        One angle [rad], which is reached in 1,000 equal steps, or increasing angles; positive and at most
        pi/4. All angles are used with both signs, together with the angle 0.
    model : Model, optional
        Default: `Independent()`.
    assignments : int
        Number of random assignments of the asperities to the sites that are also studied; default: 0.
    load_range : (float, float), optional
        Rescaled loads P/E* between which a line is fitted [mm^2]. The source does not state its range.
        Default: 25 to 100 % of the load at which the plane reaches the lowest summit.
    rng : int or numpy.random.Generator
        Seed or generator of the random assignments; default: 0.

    Returns
    -------
    xarray.Dataset
        ``slope_mean`` and ``slope_sd`` [-] over ``assignment`` ("as made", "assignment 1", ...) and ``angle``
        [rad], and ``area_mean`` and ``area_sd`` [mm^2], as made, over ``angle`` and ``rescaled_load`` [mm^2].
        With at least two random assignments, ``slope_sd_quantile`` over ``quantile`` (0.05, 0.5 and 0.95)
        and ``angle`` gives the quantiles of their `slope_sd`. ``nominal_slope`` and ``nominal_area`` are the
        values without a tilt.

    Raises
    ------
    InvalidInput
        For angles that are not positive, do not increase or exceed pi/4.
    NotConverged
        If the model has no solution at one of the angles.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(
    ...     [[0.1, 0.12], [0.11, 0.13]], (2, 2), radius=0.526, material=mf.Material(1.36)
    ... )
    >>> found = misalignment(surface, [0.0005, 0.001], assignments=3)
    >>> dict(found.slope_sd.sizes), found.slope_sd[0].round(3).values
    ({'assignment': 4, 'angle': 2}, array([0.025, 0.065]))
    """
    surface.refuse_tilt()
    angles = _angles(angle)
    used = checked_model(Independent() if model is None else model)
    load, seed = slope_loads(surface, load_range, used), seed_of(rng)
    count, sites = check.integer("assignments", assignments, at_least=0), np.arange(surface.count)
    orders = [sites, *(generator_of(seed, k).permutation(sites) for k in range(count))]
    tilt = np.outer(np.tan(np.concatenate([-angles[::-1], [0.0], angles])), [1.0, 1.0])

    laws = computed(partial(_areas, surface, used, tilt, load), orders)
    made = next(laws)
    slopes = np.array([slope(load, made), *(slope(load, each) for each in laws)])
    mean, sd = moments(angles, slopes)
    area_mean, area_sd = moments(angles, made.T)
    variables: Variables = {
        "slope_mean": (("assignment", "angle"), mean),
        "slope_sd": (("assignment", "angle"), sd),
        "area_mean": (("angle", "rescaled_load"), area_mean.T),
        "area_sd": (("angle", "rescaled_load"), area_sd.T),
        "nominal_slope": ((), slopes[0, len(angles)]),
        "nominal_area": (("rescaled_load",), made[len(angles)]),
    }
    names = ["as made", *(f"assignment {k + 1}" for k in range(count))]
    coordinates: dict[str, Any] = {"assignment": names, "angle": angles, "rescaled_load": load}
    if count > 1:
        variables["slope_sd_quantile"] = ("quantile", "angle"), np.quantile(sd[1:], QUANTILES, axis=0)
        coordinates["quantile"] = QUANTILES
    notes = [range_note(load)]
    if _touches(surface, used, tilt[-1], load[-1:]):
        at = f"at {angles[-1]:.3g} rad and a load of {load[-1]:.3g} mm^2"
        notes.append(Note(f"{at} the edge of the base plane would touch; the laws have no such contact"))
    origin = {"model": repr(used), "load_range": load[[0, -1]].tolist(), "draws": slopes.size}
    return dataset("misalignment", variables, coordinates, notes, **origin, seed=str(seed))


def _angles(angle: ArrayLike) -> FloatArray:
    """Return increasing positive angles (k,) [rad]."""
    if check.scalar(angle):
        return check.number("angle", angle, above=0.0, at_most=STEEPEST) * np.arange(1, STEPS + 1) / STEPS
    angles = check.increasing("angle", check.array("angle", angle, shape=(None,)))
    check.number(f"angle[{len(angles) - 1}]", float(angles[-1]), at_most=STEEPEST)
    return angles


def _areas(surface: Surface, model: Model, tilt: FloatArray, load: FloatArray, order: IntArray) -> FloatArray:
    """Return A0 (m, k) [mm^2] under tilts (m, 2) of the asperities in another order on the same sites."""
    placed = surface.only(order, position=surface.position)
    area = model.areas(placed, load, placed.height + tilt @ placed.position.T)
    failed = np.flatnonzero(~np.isfinite(area).all(axis=1))
    if failed.size:
        x, y = np.arctan(tilt[failed[0]])
        raise NotConverged(f"the model has no solution at a tilt of {x:.3g} rad along x and {y:.3g} along y")
    return area


def moments(angle: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of a quantity over [-angle, angle], (..., k) each.

    angle: (k,), increasing; value: (..., 2 k + 1), at these angles with both signs and at 0. The quantity is
    linear between them.
    """
    width, middle = np.diff(angle, prepend=0.0), len(angle)
    off = value - value[..., [middle]]  # small deviations keep their digits
    mean = square = np.zeros(1)
    for side in (off[..., middle:], off[..., middle::-1]):
        left, right = side[..., :-1], side[..., 1:]
        mean = mean + np.cumsum(width * (left + right) / 4.0, axis=-1) / angle
        square = square + np.cumsum(width * (left**2 + left * right + right**2) / 6.0, axis=-1) / angle
    return mean + value[..., [middle]], np.sqrt(np.maximum(square - mean**2, 0.0))


def _touches(surface: Surface, model: Model, tilt: FloatArray, load: FloatArray) -> bool:
    """Return whether the edge of the base plane would touch the plane at a tilt (2,) and a load (1,)."""
    tilted = surface.replaced(height=surface.height + surface.position @ tilt)
    approach = Independent(contact=contact_of(model)).curve(tilted, load).approach[0]
    separation = float(tilted.height.max() - approach)  # from the base plane at the origin
    block, edge = surface.block, np.abs(surface.position).max(axis=0)
    if block is not None:
        edge = np.array([block.width, block.length]) / 2.0
    return not float(tilt @ edge) < separation
