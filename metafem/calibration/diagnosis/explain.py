"""Which errors of a part explain the difference between its measured law and the design."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration.diagnosis.causes import LEAST, Causes, Priors
from metafem.calibration.diagnosis.explanation import Cause, Explanation, SingleErrors
from metafem.calibration.diagnosis.linearised import Scene
from metafem.calibration.diagnosis.sentences import NAMES
from metafem.calibration.diagnosis.shares import shares, unresolved
from metafem.calibration.diagnosis.update import NEARLY, Posterior, update
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.verdict import judged
from metafem.contact import Contact, Hertz
from metafem.errors import refuse_if
from metafem.inversion import Design
from metafem.models import Independent, Interacting, Model
from metafem.models.model import checked_model, contact_of, with_contact
from metafem.notes import Note
from metafem.progress import doing
from metafem.substrate import BondedLayer
from metafem.surface import Friction, Surface

# Probability that no error of a part within its tolerances is called an outlier.
NO_OUTLIER = 0.99


@doing("explaining the measured law")
def explain(
    measured: MeasuredLaw,
    design: Design | Surface,
    priors: Priors | None = None,
    *,
    model: Model | None = None,
) -> Explanation:
    """Which errors of a part explain the difference between its measured law and the design.

    A linear Bayesian update: each error has a Gaussian prior, the measured values y have independent Gaussian
    errors, and the posterior of the errors z, over their prior standard deviations, is that of the law
    linearised at the mean m of the posterior,

        V = (1 + J'W J)^-1,   m = V J'W (y - f(m) + J m),

    J = df/dz and W the inverse variances. It is relinearised until it converges, since the law is not linear
    where contacts open; sums of areas are averaged over the posterior. Tarantola, Inverse Problem Theory
    (SIAM, 2005), doi:10.1137/1.9780898717921, section 3.2.3.

    The error of a load enters all that was measured at this load: like the errors of the part, the true loads
    are unknowns; their means are the measured loads. Linearised, this is the effective covariance
    ``C + J_P C_P J_P'`` with its derivatives at the true loads instead of the measured ones. The error of the
    area of a contact is that of its boundary, and grows with the true area. A contact found open has no area
    with an error: its indentation is at most 0 at the largest load at which it was found open. This step
    function is replaced by the Gaussian factor with the same mean and variance (expectation propagation). The
    total area is not used if the areas of all contacts are known, since it is their sum.

    A common offset of all heights changes nothing at a given load. An outlier among the heights is larger
    than the largest error in 99 % of parts, so it does not follow the prior: its own size becomes its prior
    standard deviation, and it does not distort the other errors.

    Parameters
    ----------
    measured : MeasuredLaw
        Friction forces, total areas or areas of the contacts. Its material and friction, from the
        calibration, are the means of E* and sigma B.
    design : Design or Surface
        The designed heights, radii and positions.
    priors : Priors
        Expected errors; default: `Priors()`.
    model : Model, optional
        Default: independent asperities or, if the surface has a block and the measured values are then more
        probable, asperities interacting through the bonded layer; with the contact law of the design's model.
        Adhesive asperities are independent by default. Derivatives by errors of single asperities are those
        of independent ones. Those by common errors are closed forms for independent asperities, and central
        differences for interacting ones.

    Returns
    -------
    Explanation

    Raises
    ------
    InvalidInput
        For arguments of a wrong type, sites that are not in the design, and friction forces without a
        Friction.
    NotConverged
        If the model has no solution at a load.

    Examples
    --------
    >>> import metafem as mf
    >>> from metafem.calibration import MeasuredLaw, explain
    >>> material = mf.Material(1.36)
    >>> design = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=material)
    >>> tilted = design.tilted(0.002, 0.0)
    >>> loads = np.array([0.05, 0.1, 0.2])
    >>> areas = [mf.equilibrium(tilted, load=load).asperity_area for load in loads]
    >>> measured = MeasuredLaw(loads, asperity_area=areas, material=material)
    >>> found = explain(measured, design, model=mf.Independent())
    >>> print(found["angle_x"])
    tilt along x +0.0613° ± 0.034° (expected: 0 ± 0.05°)
    """
    check.instance("measured", measured, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    surface = design.surface if isinstance(design, Design) else design
    check.instance("design", surface, Surface, "a metafem.Design or a metafem.Surface")
    expected = Priors() if priors is None else priors
    check.instance("priors", expected, Priors, "a metafem.calibration.Priors")
    friction = measured.friction if measured.friction is not None else surface.friction
    forces = measured.friction_force is not None
    without = "measured friction forces need a design or a measured law with a Friction"
    refuse_if(forces and friction is None, without)
    _refuse_contacts(measured, surface.count)
    surface = surface.replaced(material=measured.material)
    tried = _models(model, surface, contact_of(design.law.model) if isinstance(design, Design) else Hertz())
    adhesive = contact_of(tried[0]).adhesive
    causes = Causes.of(surface, measured.load, measured.load_sd, expected, forces, adhesive)
    found = {one.name: _solved(Scene(one, causes, measured, friction)) for one in tried}
    evidence = {name: posterior.log_evidence for name, (_, posterior) in found.items()}
    best = max(evidence, key=lambda name: evidence[name])
    sites = design.sites if isinstance(design, Design) else None
    return replace(_explanation(*found[best], expected, evidence), sites=sites)


def _refuse_contacts(measured: MeasuredLaw, count: int) -> None:
    """Refuse areas of asperities that the design does not have, and closed contacts without an error."""
    area, sd, site = measured.asperity_area, measured.asperity_area_sd, measured.site
    if area is None or sd is None or site is None:
        return
    most = int(site.max())
    refuse_if(
        most >= count,
        f"site = {shown(site)} names asperity {most}; the design has {count}, numbered from 0",
    )
    uncertain = "must be greater than 0, since the contact is closed"
    check.refuse_entries("asperity_area_sd", sd, (area > 0.0) & (sd <= 0.0), uncertain)


def _models(model: Model | None, surface: Surface, contact: Contact) -> list[Model]:
    if model is not None:
        return [checked_model(model)]
    independent = Independent(contact=contact)
    # interacting adhesive contacts are solved from the first touch on: seconds for each of hundreds of states
    if surface.block is None or contact.adhesive:
        return [independent]
    return [independent, with_contact(Interacting(substrate=BondedLayer()), contact)]


def _solved(scene: Scene) -> tuple[Scene, Posterior]:
    """Return the posterior; the prior of an outlier among the heights is widened."""
    causes = scene.causes
    posterior = update(scene.linear, causes.size)
    if "height" in causes.sd:
        found = _single(causes, "height", posterior.mean, np.ones(causes.size))
        outlier = np.flatnonzero(found.outlier)
        if outlier.size:
            wide = {int(i): float(abs(found.mean[i])) for i in outlier}
            scene = replace(scene, causes=replace(causes, wide=wide))
            posterior = update(scene.linear, causes.size)
    return scene, posterior


def _explanation(
    scene: Scene, posterior: Posterior, priors: Priors, evidence: dict[str, float]
) -> Explanation:
    """Return the posterior of one model as errors of the part."""
    causes, mean, at = scene.causes, posterior.mean, posterior.linear
    sd, loads = np.sqrt(np.diag(posterior.covariance)), causes.where["load"]
    common = causes.common
    index = [causes.where[name].start for name in common]
    scale = np.array([causes.sd[name] for name in common])
    part, friction = causes.made(mean), scene.friction
    if friction is not None:
        friction = Friction(part.factor["friction"] * friction.shear_strength, friction.area_ratio)
    gradient = at.gradient
    # effective number of fitted numbers: the variances of the computed values over those of the measured ones
    fitted = float(((gradient @ posterior.covariance) * gradient).sum()) + float((sd[loads] ** 2).sum())
    share, without, before, after = shares(causes, posterior)
    return Explanation(
        causes=tuple(
            map(Cause, common, scale.tolist(), (scale * mean[index]).tolist(), (scale * sd[index]).tolist())
        ),
        covariance=posterior.covariance[np.ix_(index, index)] * scale[:, None] * scale,
        single={name: _single(causes, name, mean, sd) for name in causes.single},
        shares=share,
        misfit_without=without,
        unresolved=unresolved(causes, posterior.covariance),
        misfit_design=before,
        misfit=after,
        count=len(at.residual),
        verdict=judged(np.concatenate([-mean[loads], at.residual]), round(fitted)),
        load=part.load,
        load_sd=causes.load_sd * sd[loads],
        residual=_residuals(scene, at.residual, mean),
        log_evidence=evidence,
        surface=part.surface.replaced(friction=friction),
        friction=friction,
        model=scene.model,
        priors=priors,
        notes=tuple(_notes(causes, posterior)),
    )


def _notes(causes: Causes, posterior: Posterior) -> Iterator[Note]:
    """Return notes on a fit that has not converged, and on impossible factors of E* or sigma B."""
    if posterior.change > NEARLY:
        yield Note(
            f"the fit has not converged: its last step changed an error by {posterior.change:.2g} of its "
            f"standard deviation (limit: {NEARLY:g}), as where a contact alternately opens and closes"
        )
    for name in ("composite_modulus", "friction"):
        error = float(causes.value(name, posterior.mean)[0])
        if error <= LEAST - 1.0:
            yield Note(
                f"an error of {NAMES[name]} of {percent(error, '+.3g')} is impossible: no part explains "
                "the measured values; check the units of loads, friction forces and areas, and E*, sigma "
                "and B"
            )


def _single(causes: Causes, name: str, mean: FloatArray, sd: FloatArray) -> SingleErrors:
    """Return the errors of the asperities of one kind."""
    where, prior, scale = causes.where[name], causes.sd[name], causes.scale(name)
    shape = (-1, 2) if name == "position" else (-1,)
    largest = float(ndtri(0.5 + 0.5 * NO_OUTLIER ** (1.0 / len(scale))))
    found, deviation = ((scale * of[where]).reshape(shape) for of in (mean, sd))
    return SingleErrors(name, prior, found, deviation, np.abs(found) > largest * prior)


def _residuals(scene: Scene, residual: FloatArray, mean: FloatArray) -> dict[str, FloatArray]:
    """Return the normalised residuals by quantity."""
    k, totals = len(scene.causes.load), scene.totals
    result = dict(zip(totals, residual[: k * len(totals)].reshape(-1, k), strict=True))
    row, site, area, _ = scene.closed
    if len(area):
        table = np.full((k, scene.causes.surface.count), np.nan)
        table[row, site] = residual[k * len(totals) :]
        result["asperity_area"] = table
    return {"load": -mean[scene.causes.where["load"]], **result}
