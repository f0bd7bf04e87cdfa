"""Error bars of the friction law due to errors of its parameters, and the share of each parameter."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag
from scipy.sparse.csgraph import connected_components
from scipy.stats import qmc, sobol_indices

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.calibration.statistics import checked_covariance
from metafem.errors import NotConverged, refuse_if
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.notes import information
from metafem.prediction import default_loads
from metafem.progress import doing, each
from metafem.studies.dataset import Variables, dataset
from metafem.studies.draws import generator_of, seed_of
from metafem.studies.slope import range_note, slope, slope_loads
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# Standard deviations of parameters by name, or names and their covariance matrix.
Parameters = Mapping[str, ArrayLike] | tuple[Sequence[str], ArrayLike]

# Minimum distance of a positive parameter from zero, in standard deviations: the normal numbers of scipy's
# Sobol points are within 6.4.
WIDEST = 7.0

# Number of independent sets of points, from whose scatter the sampling errors follow.
SETS = 16

# Least number of points of a set; the two halves of fewer Sobol points are correlated.
LEAST = 64

# Laws are tabulated for errors up to this number of standard deviations; beyond it, with a probability below
# 1e-6, the area of the last load is taken.
FARTHEST = 5.0

# Number of loads in the table of a law. The error of A0 is then below 5e-4 near loads at which a contact
# closes, and 1e-7 elsewhere.
LOADS = 4000

# The model is solved at three factors of the radii, which differ by this number of standard deviations.
APART = 2.0


@doing("drawing parameters")
def uncertainty(
    surface: Surface,
    parameters: Parameters,
    *,
    draws: int = 10_000,
    model: Model | None = None,
    load: ArrayLike | None = None,
    load_range: tuple[float, float] | None = None,
    rng: Any = 0,
) -> xr.Dataset:
    """Return the error bars of the law due to Gaussian errors of its parameters, and each parameter's share.

    A0 is computed at the load P/E* with random values of R, E* and P, and ``F = sigma B A0`` also with random
    values of sigma and B; `metafem.calibration.compare` has the error bars of measured laws.
    Source: Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text
    "Uncertainties", error bars of Figs. 3 to 5.

    Parameters
    ----------
    surface : Surface
        The surface with the mean values of R, E*, sigma and B.
    parameters : mapping of str to float, or (sequence of str, array_like (p, p))
        Standard deviations of ``radius`` [mm] (all radii change by the same factor), ``composite_modulus``
        [MPa], ``load`` [N], a number or one for each load, ``shear_strength`` [MPa] and ``area_ratio`` [-].
        Or the names of parameters and their covariance matrix, in these units.
    draws : int
        Number of evaluations, at least 2, rounded up to 16 sets of Sobol points; default: 10,000.
    model : Model, optional
        Default: `Independent()`.
    load : array_like, (k,), optional
        Normal loads P [N], positive. Default: the 100 loads of `friction_law`.
    load_range : (float, float), optional
        Rescaled loads P/E* between which a line is fitted [mm^2]. Default: 25 to 100 % of the load at which
        the plane reaches the lowest summit.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.

    Returns
    -------
    xarray.Dataset
        ``area_mean`` and ``area_sd`` [mm^2] over ``rescaled_load`` [mm^2], the error bars of the law, and
        ``friction_force_...`` [N] with a Friction. ``slope_mean`` and ``slope_sd`` [-] are those over the
        nominal P/E*. ``NAME_first_order`` and ``NAME_total`` over ``parameter`` are the Sobol indices: the
        share of the variance that a parameter explains by itself, and the share that remains if all others
        are known (`scipy.stats.sobol_indices`). Correlated parameters share one entry. Each estimate has its
        standard sampling error ``..._error``.

    Raises
    ------
    InvalidInput
        For unknown names, standard deviations that are negative or above a seventh of a positive parameter, a
        covariance matrix that is not symmetric and positive semidefinite, and fewer than two draws.
    NotConverged
        If the model has no solution at a load or radius that is needed.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> found = uncertainty(surface, {"radius": 0.005, "composite_modulus": 0.04}, load=[0.03])
    >>> found.area_sd.round(4).values, found.area_total[:, 0].round(2).values
    (array([0.0035]), array([0.09, 0.91]))
    """
    used = checked_model(Independent() if model is None else model)
    number, seed = check.integer("draws", draws, at_least=2), seed_of(rng)
    if load is None:
        loads = surface.material.composite_modulus * default_loads(surface, used)
    else:
        loads = check.array("load", load, shape=(None,), positive=True)
    sd, correlation = _inputs(parameters, nominal_values(surface) | {"load": loads})
    law = contact_of(used)
    refuse_if(
        "composite_modulus" in sd and law.scales_with_stress,
        f"also changes the law {law}, whose energy or stress is compared with it; take the contact law "
        "Hertz(), or leave the modulus out",
        key="parameters.composite_modulus",
    )
    fitted, note = None, information("no slope: all summits have one height, and no load_range is given")
    modulus, last = surface.material.composite_modulus, float(loads.max())
    if load_range is not None or np.ptp(surface.height) > 0.0:
        fitted = slope_loads(surface, load_range, used)
        last, note = max(last, modulus * fitted[-1]), range_note(fitted)
    area = tabulated(surface, used, sd, last)
    quantities = partial(_quantities, surface, sd, area, fitted, loads)

    variables, groups, count = _estimated(quantities, correlation, number, seed)
    labels = [" + ".join(np.array(list(sd))[group]) for group in groups]
    coordinates = {"rescaled_load": loads / modulus, "parameter": labels}
    origin = {"model": repr(used), "seed": str(seed), "draws": count}
    ends = [] if fitted is None else fitted[[0, -1]].tolist()
    return dataset("uncertainty", variables, coordinates, [note], **origin, load_range=ends)


def nominal_values(surface: Surface) -> dict[str, Any]:
    """Return the nominal values of the parameters of a surface."""
    friction = {} if surface.friction is None else vars(surface.friction)
    modulus = surface.material.composite_modulus
    return {"radius": float(surface.radius.mean()), "composite_modulus": modulus, **friction}


def _inputs(parameters: Parameters, mean: Mapping[str, Any]) -> tuple[dict[str, FloatArray], FloatArray]:
    """Return the standard deviation (1,) or (k,) of each parameter, and their correlations (p, p).

    A number must stay positive under its errors; the values of an array may have any size.
    """
    if isinstance(parameters, Mapping):
        given, correlation = {**parameters}, np.eye(len(parameters))
    else:
        names, matrix = checked_covariance(*parameters, [*mean])
        deviation = np.sqrt(np.diagonal(matrix))
        given = dict(zip(names, deviation, strict=True))
        correlation = matrix / np.outer(*[np.where(deviation > 0.0, deviation, 1.0)] * 2)
    known = f"{', '.join(mean)}; those of friction need a Friction"
    found = {}
    for name, value in given.items():
        label = f"parameters.{name}"
        refuse_if(name not in mean, f"is none of the parameters {known}", key=label)
        if np.ndim(mean[name]) and not check.scalar(value):
            found[name] = check.loads(label, check.array(label, value, shape=mean[name].shape))
            continue
        most = None if np.ndim(mean[name]) else mean[name] / WIDEST
        found[name] = np.array([check.number(label, value, at_least=0.0, at_most=most)])
    words = "parameters are all without errors; one standard deviation must be above 0"
    refuse_if(not any(value.any() for value in found.values()), words)
    return found, correlation


def tabulated(
    surface: Surface, model: Model, sd: Mapping[str, FloatArray], load: float
) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """Return A0 [mm^2] as a function of P/E* [mm^2] and of a factor s of all radii, by interpolation.

    For independent Hertz contacts ``A0(P/E*, s) = s A0(P/E*/sqrt(s), 1)``. In this form the area is linear in
    ``(P/E*/sqrt(s))^(2/3)`` between the loads of the table, which reaches the largest likely rescaled load
    from the largest nominal load [N], and a parabola in s.
    """
    widest: dict[str, float] = defaultdict(float, {name: float(value.max()) for name, value in sd.items()})
    radius_sd = widest["radius"] / float(surface.radius.mean())
    last = load + FARTHEST * widest["load"]
    last /= surface.material.composite_modulus - FARTHEST * widest["composite_modulus"]
    last /= np.sqrt(1.0 - FARTHEST * radius_sd)
    coordinate, step, area = np.linspace(0.0, last ** (2.0 / 3.0), LOADS), APART * radius_sd, []
    for factor in (1.0 - step, 1.0, 1.0 + step):
        loads = np.sqrt(factor) * coordinate**1.5
        area.append(model.areas(surface, loads, surface.height[None], factor * surface.radius[None])[0])
        failed = loads[~np.isfinite(area[-1])]
        if failed.size:
            raise NotConverged(f"the model has no solution at the rescaled load {failed[0]:.3g} mm^2")
    low, middle, high = area[0] / (1.0 - step), area[1], area[2] / (1.0 + step)
    parabola = middle, (high - low) / 2.0, (high + low) / 2.0 - middle

    def interpolated(load: FloatArray, factor: FloatArray) -> FloatArray:
        x = (np.maximum(load, 0.0) / np.sqrt(factor)) ** (2.0 / 3.0)
        t = (factor - 1.0) / step if step > 0.0 else np.zeros(1)
        constant, linear, square = (np.interp(x, coordinate, row) for row in parabola)
        return np.asarray(factor * (constant + t * (linear + t * square)))

    return interpolated


def _quantities(
    surface: Surface,
    sd: Mapping[str, FloatArray],
    area: Callable[[FloatArray, FloatArray], FloatArray],
    fitted: FloatArray | None,
    load: FloatArray,
    normal: FloatArray,
) -> dict[str, FloatArray]:
    """Return the quantities (..., k) by name for normal numbers (..., p); the slope has k = 1.

    fitted: (j,), the loads P/E* of the slope, if there is one.
    """
    errors: dict[str, FloatArray] = defaultdict(lambda: np.zeros(1))
    errors |= {name: normal[..., [i]] * value for i, (name, value) in enumerate(sd.items())}
    material, friction = surface.material, surface.friction
    modulus = material.composite_modulus + errors["composite_modulus"]
    factor = 1.0 + errors["radius"] / surface.radius.mean()
    found = {"area": area((load + errors["load"]) / modulus, factor)}
    if friction is not None:
        strength = friction.shear_strength + errors["shear_strength"]
        stress = strength * (friction.area_ratio + errors["area_ratio"])
        found["friction_force"] = stress * found["area"]
    if fitted is not None:
        moved = area(fitted * material.composite_modulus / modulus, factor)
        found["slope"] = slope(fitted, moved)[..., None]
    # a quantity that depends on no random parameter has the same value at all points
    shape = normal.shape[:-1]
    return {name: np.broadcast_to(value, (*shape, value.shape[-1])) for name, value in found.items()}


def _estimated(
    quantities: Callable[[FloatArray], dict[str, FloatArray]],
    correlation: FloatArray,
    draws: int,
    seed: int,
) -> tuple[Variables, NDArray[np.bool_], int]:
    """Return the variables of all quantities, the groups of parameters (g, p), and the number of draws."""
    count, label = connected_components(correlation != 0.0)
    groups = label == np.arange(count)[:, None]
    runs = SETS * (2 + count)  # evaluations of the law at each point
    points = max(LEAST, 2 ** math.ceil(math.log2(draws / runs)))
    sets = [
        _sampled(quantities, correlation, groups, generator_of(seed, k), points)
        for k in each("set of points", range(SETS))
    ]
    variables: Variables = {}
    for name, nominal in quantities(np.zeros(len(correlation))).items():
        # the slope has a single value
        axes, part = ((), 0) if name == "slope" else (("rescaled_load",), slice(None))
        variables[f"nominal_{name}"] = axes, nominal[part]
        for statistic, (value, error) in _estimates([values[name] for values in sets]).items():
            over = axes if statistic in ("mean", "sd") else ("parameter", *axes)
            variables[f"{name}_{statistic}"] = over, value[..., part]
            variables[f"{name}_{statistic}_error"] = over, error[..., part]
    return variables, groups, runs * points


def _sampled(
    quantities: Callable[[FloatArray], dict[str, FloatArray]],
    correlation: FloatArray,
    groups: NDArray[np.bool_],
    random: np.random.Generator,
    points: int,
) -> dict[str, dict[str, FloatArray]]:
    """Return each quantity at two sets of points, and with the columns of each group exchanged, (g, p).

    The values have the names and the shapes (k, points) and (g, k, points) that `sobol_indices` takes.
    """
    both = block_diag(correlation, correlation)
    normal = qmc.MultivariateNormalQMC(np.zeros(len(both)), both, rng=random).random(points)
    first, second = np.split(normal, 2, axis=1)
    mixed = np.where(groups[:, None], second, first)
    at = {"f_A": quantities(first), "f_B": quantities(second), "f_AB": quantities(mixed)}
    return {name: {key: np.moveaxis(of[name], -1, -2) for key, of in at.items()} for name in at["f_A"]}


def _estimates(sets: list[dict[str, FloatArray]]) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return the statistics of all sets of points, each with its sampling error by their scatter."""
    whole = _statistics({key: np.concatenate([of[key] for of in sets], axis=-1) for key in sets[0]})
    scatter = [_statistics(values) for values in sets]
    return {
        name: (value, np.std([found[name] for found in scatter], axis=0, ddof=1) / np.sqrt(SETS))
        for name, value in whole.items()
    }


def _statistics(values: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return mean and standard deviation (k,), and the Sobol indices (g, k)."""
    both = np.concatenate([values["f_A"], values["f_B"]], axis=-1)
    # a copy of the first value: scipy's indices have no axis for a single one
    twice = {key: np.concatenate([value, value[..., :1, :]], axis=-2) for key, value in values.items()}
    found = sobol_indices(func=twice, n=values["f_A"].shape[-1])
    shape = len(both) + 1, -1
    first, total = (np.reshape(part, shape).T[:, :-1] for part in (found.first_order, found.total_order))
    return {"mean": both.mean(axis=-1), "sd": both.std(axis=-1), "first_order": first, "total": total}
