"""Error bars of the friction law due to errors of its parameters, and the share of each parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem.errors import refuse_if
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.notes import Note
from metafem.prediction.friction_law import default_loads
from metafem.progress import doing
from metafem.studies.sampling.batches import Execution, opened
from metafem.studies.sampling.dataset import Variables, dataset, with_error
from metafem.studies.sampling.inputs import Inputs, values_of
from metafem.studies.sampling.law_draws import LawDraws, Response
from metafem.studies.sampling.points import MOST_DRAWS, Draws, entropy
from metafem.studies.sampling.slope import Slope
from metafem.studies.sampling.sobol_indices import SobolIndices, estimated, plan
from metafem.studies.sampling.store import inputs_hash
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# Initial number of draws if draws are added until an error is reached.
FIRST_DRAWS = 5_000


@doing("drawing parameters")
def uncertainty(
    surface: Surface,
    parameters: Mapping[str, ArrayLike] | tuple[Sequence[str], ArrayLike],
    *,
    draws: int | Draws = 10_000,
    model: Model | None = None,
    load: ArrayLike | None = None,
    friction_force: ArrayLike | None = None,
    load_range: tuple[float, float] | None = None,
    rng: Any = 0,
    execution: Execution | None = None,
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
    draws : int or metafem.studies.Draws
        Number of evaluations, at least 2, rounded up to full batches; default: 10,000. With
        ``Draws(error=...)``, draws are added until ``area_sd`` has this relative error at all loads.
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
    execution : metafem.studies.Execution, optional
        Processes or cluster, and folder of a run that can be resumed; default: this process.

    Returns
    -------
    xarray.Dataset
        ``area_mean`` and ``area_sd`` [mm^2] over ``rescaled_load`` [mm^2], the error bars of the law;
        ``slope_mean`` and ``slope_sd`` [-] describe the slope over the nominal P/E*, without errors of the
        load. If the surface has a Friction, there are ``friction_force_mean`` and ``friction_force_sd`` [N];
        measured pairs have ``rescaled_load_...``, ``rescaled_friction_...`` and ``deviation_...`` [mm^2]
        instead. ``NAME_first_order`` and ``NAME_total`` over ``parameter`` are the Sobol indices: the share
        of the variance that a parameter explains by itself, and the share that remains if all others are
        known. Correlated parameters share one entry. Each estimate has its standard sampling error
        ``..._error``. ``saving`` is the number of plain random draws that give the same error of ``area_sd``,
        divided by the number of draws used, for a normally distributed A0.

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
    number = Draws.of(draws)
    wanted = number.error
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
        "with it; take a law without them (contact hertz), use the study combined, which solves each "
        "draw with its own modulus, or leave the modulus out",
    )
    fit, notes = Slope.if_any(surface, load_range, used)
    groups = len(inputs.groups)
    size, points = plan(number.number if wanted is None else FIRST_DRAWS, groups)
    response = Response.reaching(surface, used, inputs, loads, fit)
    task = LawDraws(surface, inputs, response, fit, loads, forces, points, entropy(rng))
    key = inputs_hash((task, used, size, wanted))
    first = 0
    with opened(execution, "uncertainty", key) as compute:
        while True:
            batches = compute(replace(task, points=points), range(first, first + size))
            done = size * points * (2 + 2 * groups)
            found = estimated(np.array([batch["means"] for batch in batches]), task.nominal)
            area = slice(0, len(loads))
            enough = wanted is None or (found.sd.error[area] <= wanted * found.sd.value[area]).all()
            if enough or done >= MOST_DRAWS:
                break
            # start again with twice as many points: one larger Sobol net is more accurate than two
            first, (size, points) = first + size, plan(2 * done, groups)
    if not enough:
        notes.append(Note(f"the sampling error of area_sd exceeds {wanted:g} after {done} draws"))
    return _dataset(task, found, used, done, key, notes)


def _dataset(
    task: LawDraws, found: SobolIndices, model: Model, draws: int, key: str, notes: list[Note]
) -> xr.Dataset:
    """Return the dataset that holds the estimates of all outputs."""
    k = len(task.load)
    variables: Variables = {}
    for i, name in enumerate(task.outputs):
        # the slope is the last output and has a single value
        part, over = (-1, ()) if name == "slope" else (slice(i * k, (i + 1) * k), ("rescaled_load",))
        for statistic, estimate in found._asdict().items():
            axes = over if statistic in ("mean", "sd") else ("parameter", *over)
            own = estimate.value[..., part], estimate.error[..., part]
            variables |= with_error(f"{name}_{statistic}", axes, own)
        variables[f"nominal_{name}"] = over, task.nominal[part]
    variables.pop("nominal_rescaled_load", None)  # the coordinate holds these values
    sd, error = found.sd.value[:k], found.sd.error[:k]
    plain = sd**2 / (2.0 * draws)  # sampling variance of the SD of normal draws
    variables["saving"] = ("rescaled_load",), np.divide(plain, error**2, np.ones(k), where=error > 0.0)
    rescaled = task.load / task.surface.material.composite_modulus
    return dataset(
        "uncertainty",
        variables,
        {"rescaled_load": rescaled, "parameter": task.inputs.labels},
        model=model,
        slope=task.fit,
        seed=task.seed,
        draws=draws,
        inputs=key,
        notes=notes,
    )
