"""Probability that a surface with all errors at once meets the target, and the largest tolerances."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem._given import Given
from metafem._values import percent
from metafem.errors import NotConverged, refuse_if
from metafem.inversion import Design
from metafem.inversion.assessment import MISSED
from metafem.models import Model
from metafem.models.model import checked_model
from metafem.notes import Note, information
from metafem.prediction import Tolerances
from metafem.progress import doing
from metafem.studies.largest_tolerances import ALL, factors, quantile
from metafem.studies.made_laws import MadeLaws, described, share_error
from metafem.studies.sampling.batches import Execution, opened
from metafem.studies.sampling.dataset import QUANTILES, Variables, dataset, of_law, with_error
from metafem.studies.sampling.inputs import NO_INPUTS, Inputs, values_of
from metafem.studies.sampling.moments import Estimate, moments
from metafem.studies.sampling.points import Draws, batch_size, entropy
from metafem.studies.sampling.slope import Slope
from metafem.studies.sampling.store import inputs_hash

if TYPE_CHECKING:
    import xarray as xr

# Largest number of points of a batch; such a batch takes half a second on a bonded layer.
MOST_POINTS = 256

# Initial number of draws if draws are added until an error is reached.
FIRST_DRAWS = 4_096


@dataclass(frozen=True)
class Requirement:
    """Largest misfit of a made surface, and the required probability that the misfit is not exceeded.

    Parameters
    ----------
    misfit : float
        Largest misfit [-] at which a made surface meets the target, positive; default: 0.1, the largest
        difference that the source paper counts as a success.
    probability : float
        Required probability [-], above 0 and below 1; default: 0.9.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> Requirement(0.02)
    Requirement(misfit=0.02, probability=0.9)
    """

    misfit: float = MISSED
    probability: float = 0.9

    def __post_init__(self) -> None:
        check.member(self, "misfit", above=0.0)
        check.member(self, "probability", above=0.0)
        most = Given("probability", 1.0)
        beyond = self.probability >= 1.0
        refuse_if(beyond, "must be below {.number}", most, key="probability", value=self.probability)


@doing("drawing made surfaces")
def combined(
    design: Design,
    tolerances: Tolerances,
    *,
    requirement: Requirement | None = None,
    parameters: Mapping[str, float] | None = None,
    draws: int | Draws = 10_000,
    model: Model | None = None,
    load_range: tuple[float, float] | None = None,
    rng: Any = 0,
    execution: Execution | None = None,
) -> xr.Dataset:
    """Return the probability that a made surface meets the target, and the largest allowed tolerances.

    Each draw has errors of its heights, radii, positions, alignment and parameters at once. Its law under the
    model is compared with the target in the same way as the law of the design: the misfit has the definition
    of `Design.misfit`, and free parameters of the target are fitted to each law. A draw whose law has no
    solution does not meet the target.

    The largest tolerances are multiples of the given tolerances: a common factor of all tolerances, and a
    factor of each tolerance while the others stay as given. At the largest factor, the quantile of the misfit
    at the required probability equals the largest allowed misfit. The factor is found by false position, with
    a fifth of the draws and the same random numbers at all factors; a final step uses all draws. For 64
    asperities, 10,000 draws take seconds without interaction and minutes with interaction. Aymard et al.,
    Science 383, 200 (2024), doi:10.1126/science.adk4234, Figs. S2 and S3, show the effects of single errors.

    Parameters
    ----------
    design : Design
    tolerances : Tolerances
        Errors of the made surface and of its alignment.
    requirement : metafem.studies.Requirement, optional
        Largest misfit and required probability; default: ``Requirement(misfit=0.1, probability=0.9)``.
    parameters : mapping of str to float, optional
        Standard deviations of ``composite_modulus`` [MPa], ``radius`` [mm] (of the mean radius; all radii
        change by the same factor), ``shear_strength`` [MPa] and ``area_ratio`` [-], as for `uncertainty`.
        These errors change the friction force at a load; the forces are rescaled with the nominal values and
        compared with the target. The factors do not multiply these errors. Default: none.
    draws : int or metafem.studies.Draws
        Number of draws, at least 2; default: 10,000. With ``Draws(error=...)``, draws are added until the
        probability has this error.
    model : Model, optional
        Default: the model of the design's law.
    load_range : (float, float), optional
        Rescaled loads P/E* between which the slope is fitted [mm^2]. Default: 25 to 100 % of the load at
        which the plane reaches the lowest summit.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.
    execution : metafem.studies.Execution, optional
        Processes or cluster, and folder of a run that can be resumed; default: this process.

    Returns
    -------
    xarray.Dataset
        ``probability`` [-] that the misfit is at most the allowed one; ``misfit_quantile`` [-] over
        ``quantile`` (0.05, 0.5, 0.95), and ``nominal_misfit`` without errors. ``factor`` [-] over
        ``tolerance`` ("all" and the names of the tolerances that are not 0) is the largest multiple of the
        tolerance ``given`` [mm or rad; 1 for "all"]. It is nan if the probability is too small even without
        this error, and infinite if the probability is large enough at the largest multiple tried; notes say
        so. ``slope_mean``, ``slope_sd`` [-], ``area_mean`` and ``area_sd`` [mm^2] over ``rescaled_load``
        describe the laws; ``nominal_slope`` and ``nominal_area`` are the values without errors. Each estimate
        has its standard sampling error ``NAME_error``. There is no slope if all summits have the same height
        and no load range is given. ``failed`` is the number of draws without a solution.

    Raises
    ------
    InvalidInput
        For fewer than two draws, a probability that is not between 0 and 1, and unknown parameters.
    NotConverged
        If the model has no solution for the surface of the design.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.PowerLaw(0.9, (0.02, 0.06)), template)
    >>> found = combined(design, mf.Tolerances(height_sd=0.003), requirement=Requirement(0.02), draws=500)
    >>> found.tolerance.values.tolist(), bool(0.0 < found.probability < 1.0)
    (['all', 'height_sd'], True)
    """
    wish, number = requirement or Requirement(), Draws.of(draws)
    allowed, wanted, goal = wish.misfit, wish.probability, number.error
    surface = design.surface
    tolerances.refuse_shape("the study combined")
    used = design.law.model if model is None else checked_model(model)
    slope, notes = Slope.if_any(surface, load_range, used)
    first = number.number if goal is None else FIRST_DRAWS
    task = MadeLaws(
        surface,
        used,
        tolerances,
        Inputs.of(parameters, None, values_of(surface)) if parameters else NO_INPUTS,
        design.target_law,
        tuple(branch for branch, _ in design.fits),
        slope,
        seed=entropy(rng),
        size=min(batch_size(first), MOST_POINTS),
        draws=first,
    )
    key = inputs_hash((task, allowed, wanted, goal))
    with opened(execution, "combined", key) as compute:
        drawn, sums = described(compute, task, allowed, goal)
        found = factors(
            lambda task: np.concatenate([batch["misfit"] for batch in compute(task, task.batches)]),
            task, drawn, allowed, wanted,
        )  # fmt: skip
    if sums["count"] < 2:
        raise NotConverged("fewer than two draws have a solution")
    notes += _notes(found, wanted, allowed)
    if slope is not None:
        notes.append(slope.note)
    if sums["failed"]:
        notes.append(Note(f"{sums['failed']} draws have no solution under this model: they miss the target"))
    met, count = float((drawn <= allowed).mean()), len(drawn)
    if goal is not None and share_error(met, count) > goal:
        notes.append(Note(f"the error {goal:g} of the probability is not reached within {count} draws"))
    levels, load, over = [quantile(drawn, share) for share in QUANTILES], "rescaled_load", ("tolerance",)
    variables: Variables = {
        **with_error("probability", (), (met, share_error(met, count))),
        **with_error("misfit_quantile", ("quantile",), list(np.transpose(levels))),
        **with_error("factor", over, np.array(list(found.values())).reshape(-1, 2).T),
        "nominal_misfit": ((), task.nominal[0]),
        "given": (over, [1.0 if name == ALL else getattr(tolerances, name) for name in found]),
        "failed": ((), sums["failed"]),
        "draws": ((), sums["count"]),
        **of_law(moments(sums, plain=True)[:2], task.nominal[1], slope=slope is not None),
    }
    result = dataset(
        "combined",
        variables,
        {load: task.shown, "quantile": QUANTILES, "tolerance": np.array(list(found), dtype=str)},
        model=used,
        slope=slope,
        seed=task.seed,
        draws=count,
        inputs=key,
        notes=notes,
    )
    return result.assign_attrs(
        misfit=allowed,
        wanted_probability=wanted,
        tolerances=repr(tolerances),
        parameters=repr(dict(parameters or {})),
    )


def _notes(found: Mapping[str, Estimate], wanted: float, allowed: float) -> Iterator[Note]:
    """Yield a note for each tolerance whose largest value was not found."""
    meets = f"a probability of {percent(wanted, '.3g')} of a misfit of at most {percent(allowed, '.3g')}"
    for name, value in found.items():
        if math.isnan(value.value):
            without = "errors of the surface" if name == ALL else f"{name}, with the other errors as given"
            yield Note(f"{meets} is not reached even without {without}")
        elif math.isinf(value.value):
            what = "all tolerances" if name == ALL else name
            yield information(f"{meets} is exceeded up to the largest multiple of {what} that was tried")
