"""Error bars of the friction law due to errors of its parameters, and the share of each parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import qmc, sobol_indices

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.notes import Note
from metafem.prediction.friction_law import default_loads
from metafem.progress import doing, each
from metafem.studies.sampling.dataset import Estimate, Variables, dataset, with_error
from metafem.studies.sampling.inputs import Inputs, values_of
from metafem.studies.sampling.law_draws import LawDraws, Response
from metafem.studies.sampling.points import entropy, generator_of
from metafem.studies.sampling.slope import Slope
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# Number of independent sets of points, from whose scatter the sampling errors follow.
SETS = 16

# Least number of points of a set; the two halves of fewer Sobol points are correlated.
LEAST = 64

# Number of bits of the coordinates of Sobol points; the default of scipy.
BITS = 30


@doing("drawing parameters")
def uncertainty(
    surface: Surface,
    parameters: Mapping[str, ArrayLike] | tuple[Sequence[str], ArrayLike],
    *,
    draws: int = 10_000,
    model: Model | None = None,
    load: ArrayLike | None = None,
    friction_force: ArrayLike | None = None,
    load_range: tuple[float, float] | None = None,
    rng: Any = 0,
) -> xr.Dataset:
    """Return the error bars of the law due to Gaussian errors of its parameters, and each parameter's share.

    For a prediction, ``A0 = F/(sigma B)`` is computed at the load P/E* with random values of R, E* and P, and
    ``F = sigma B A0`` also with random values of sigma and B. For measured pairs, P/E* and F/(sigma B) are
    computed with random values of P, F, E*, sigma and B. The ``deviation`` of the pairs from the prediction,
    F/(sigma B) - A0(P/E*), also depends on R. Source: Aymard et al., Science 383, 200 (2024),
    doi:10.1126/science.adk4234, supplementary text "Uncertainties", error bars of Figs. 3 to 5.

    The areas at the random loads and radii are interpolated between laws of the model at three radii. For
    independent asperities, the dependence on the radius is exact.

    Parameters
    ----------
    surface : Surface
        The surface with the mean values of R, E*, sigma and B.
    parameters : mapping of str to float, or (sequence of str, array_like (p, p))
        Standard deviations of ``radius`` [mm] (of the mean radius; all radii change by the same factor),
        ``composite_modulus`` [MPa], ``load`` [N], ``shear_strength`` [MPa] and ``area_ratio`` [-], and of
        ``friction_force`` [N] for measured pairs; or the names of parameters and their covariance matrix, in
        these units. The standard deviations of load and friction force may be arrays (k,). Parameters that
        are not named have no error.
    draws : int
        Number of evaluations, at least 2, rounded up to 16 sets of Sobol points; default: 10,000.
    model : Model, optional
        Default: `Independent()`.
    load : array_like, (k,), optional
        Normal loads P [N], positive. Default: the 100 loads of `friction_law`.
    friction_force : array_like, (k,), optional
        Friction forces F [N], positive, measured at the loads `load`; default: the law is predicted.
    load_range : (float, float), optional
        Rescaled loads P/E* between which a line is fitted [mm^2]. Default: 25 to 100 % of the load at which
        the plane reaches the lowest summit.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.

    Returns
    -------
    xarray.Dataset
        ``area_mean`` and ``area_sd`` [mm^2] over ``rescaled_load`` [mm^2], the error bars of the law;
        ``slope_mean`` and ``slope_sd`` [-] describe the slope over the nominal P/E*, without errors of the
        load. If the surface has a Friction, there are ``friction_force_mean`` and ``friction_force_sd`` [N];
        measured pairs have ``rescaled_load_...``, ``rescaled_friction_...`` and ``deviation_...`` [mm^2]
        instead. ``NAME_first_order`` and ``NAME_total`` over ``parameter`` are the Sobol indices: the share
        of the variance that a parameter explains by itself, and the share that remains if all others are
        known (`scipy.stats.sobol_indices`). Correlated parameters share one entry. Each estimate has its
        standard sampling error ``..._error``.

    Raises
    ------
    InvalidInput
        For unknown names, negative standard deviations, standard deviations above a seventh of a positive
        parameter, a covariance matrix that is not symmetric and positive semidefinite, and fewer than two
        draws; and for friction forces or their parameters if the surface has no Friction.
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
    number, seed = check.integer("draws", draws, at_least=2), entropy(rng)
    errors, covariance = parameters if isinstance(parameters, tuple) else (parameters, None)
    words = "friction_force must be given with the load of each measured pair"
    refuse_if(load is None and friction_force is not None, words)
    if load is None:
        loads = surface.material.composite_modulus * default_loads(surface, used)
    else:
        loads = check.array("load", load, shape=(None,), positive=True)
    means, forces = {**values_of(surface), "load": loads}, None
    if friction_force is not None:
        forces = check.array("friction_force", friction_force, shape=(len(loads),), positive=True)
        refuse_if(surface.friction is None, "friction_force needs a surface with a Friction")
        means["friction_force"] = forces
    inputs = Inputs.of(errors, covariance, means)
    law = contact_of(used)
    refuse_if(
        "composite_modulus" in inputs.names and law.scales_with_stress,
        f"parameters: composite_modulus also changes the law {law!r}, whose energy or stress is compared "
        "with it; take a law without them (contact hertz), or leave the modulus out",
    )
    fit, notes = Slope.if_any(surface, load_range, used)
    response = Response.reaching(surface, used, inputs, loads, fit)
    task = LawDraws(surface, inputs, response, fit, loads, forces)
    points = LEAST
    while SETS * points * (2 + len(inputs.groups)) < number:
        points *= 2
    sets = [_values(task, seed, k, points) for k in each("set of points", range(SETS))]
    return _dataset(task, sets, used, seed, SETS * points * (2 + len(inputs.groups)), notes)


def _values(task: LawDraws, seed: int, number: int, points: int) -> dict[str, FloatArray]:
    """Return the outputs at two independent sets of points, and with the columns of each group exchanged.

    They have the names and the shapes (q, points) and (g, q, points) that `scipy.stats.sobol_indices` takes.
    """
    inputs = task.inputs
    net = qmc.Sobol(2 * len(inputs.names), bits=BITS, rng=generator_of(seed, number)).random(points)
    net += 0.5 ** (BITS + 1)  # centres of the rounding intervals, so that none is 0
    a, b = np.split(net, 2, axis=1)
    mixed = np.array([a] * len(inputs.groups))
    for part, group in zip(mixed, map(list, inputs.groups), strict=True):
        part[:, group] = b[:, group]
    values = {"f_A": task.law(a), "f_B": task.law(b), "f_AB": task.law(mixed)}
    # a copy of the first output: scipy's indices have no axis for a single one
    own = np.append(np.arange(len(task.nominal)), 0)
    return {name: np.moveaxis(value, -1, -2)[..., own, :] for name, value in values.items()}


def _estimates(values: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return mean and standard deviation (q,), and the Sobol indices (g, q)."""
    both = np.concatenate([values["f_A"], values["f_B"]], axis=-1)[:-1]
    found = sobol_indices(func=values, n=values["f_A"].shape[-1])
    first, total = (
        np.reshape(part, (len(both) + 1, -1)).T[:, :-1] for part in (found.first_order, found.total_order)
    )
    return {"mean": both.mean(axis=-1), "sd": both.std(axis=-1), "first_order": first, "total": total}


def _dataset(
    task: LawDraws, sets: list[dict[str, FloatArray]], model: Model, seed: int, draws: int, notes: list[Note]
) -> xr.Dataset:
    """Return the dataset that holds the estimates of all outputs."""
    whole = _estimates({name: np.concatenate([each[name] for each in sets], axis=-1) for name in sets[0]})
    parts = [_estimates(values) for values in sets]
    found = {
        name: Estimate(value, np.std([part[name] for part in parts], axis=0, ddof=1) / np.sqrt(SETS))
        for name, value in whole.items()
    }
    k = len(task.load)
    variables: Variables = {}
    for i, name in enumerate(task.outputs):
        # the slope is the last output and has a single value
        part, over = (-1, ()) if name == "slope" else (slice(i * k, (i + 1) * k), ("rescaled_load",))
        for statistic, estimate in found.items():
            axes = over if statistic in ("mean", "sd") else ("parameter", *over)
            own = estimate.value[..., part], estimate.error[..., part]
            variables |= with_error(f"{name}_{statistic}", axes, own)
        variables[f"nominal_{name}"] = over, task.nominal[part]
    variables.pop("nominal_rescaled_load", None)  # the coordinate holds these values
    rescaled = task.load / task.surface.material.composite_modulus
    return dataset(
        "uncertainty",
        variables,
        {"rescaled_load": rescaled, "parameter": task.inputs.labels},
        model=model,
        slope=task.fit,
        seed=seed,
        draws=draws,
        notes=notes,
    )
