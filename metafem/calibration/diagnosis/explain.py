"""Search for the errors of a part that explain why its measured law differs from the design."""

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
from metafem.contact import Contact
from metafem.contact.by_profile import usual_law
from metafem.errors import refuse_if
from metafem.inversion import Design
from metafem.models import Independent, Interacting, Model
from metafem.models.model import checked_model, contact_of, with_contact
from metafem.notes import Note
from metafem.progress import doing
from metafem.substrate import BondedLayer
from metafem.surface import Friction, Surface

# Probability that no asperity of a part within its tolerances is classified as an outlier.
NO_OUTLIER = 0.99


@doing("explaining the measured law")
def explain(
    measured: MeasuredLaw,
    design: Design | Surface,
    priors: Priors | None = None,
    *,
    model: Model | None = None,
) -> Explanation:
    """Return the errors of a part that explain why its measured law differs from the design.

    The method is a linear Bayesian update. Each error has a Gaussian prior; z are the errors over their prior
    standard deviations. The measured values y have independent Gaussian errors. The posterior of z is
    computed with the law f linearised at the posterior mean m,

        V = (1 + J'W J)^-1,   m = V J'W (y - f(m) + J m),

    with J = df/dz and the inverse variances W. The linearisation is repeated until m converges, because the
    law is not linear where contacts open. Sums of areas are averaged over the posterior. Tarantola, Inverse
    Problem Theory (SIAM, 2005), doi:10.1137/1.9780898717921, section 3.2.3.

    The error of a load affects every value measured at this load. Therefore the true loads are unknowns too,
    and the measured loads are their prior means. After linearisation, this is equivalent to an effective
    covariance ``C + J_P C_P J_P'`` of the measured values, with the covariance C_P of the loads and the
    derivatives J_P at the true loads. The error of a contact area follows from the error of the contact's
    boundary, and grows with the true area. If a contact was found open, the data state only that its
    indentation is at most 0 at the largest load at which it was open. This step function in the likelihood is
    replaced by the Gaussian factor with the same mean and variance (expectation propagation). If the areas of
    all contacts are known, their sum, the total area, is not used.

    A common offset of all heights has no effect at a fixed load. A height error counts as an outlier if it
    exceeds the largest error in 99 % of parts. An outlier does not follow the prior. To keep it from
    distorting the other errors, its prior standard deviation is set to its own size.

    Parameters
    ----------
    measured : MeasuredLaw
        Friction forces, total areas or areas of the contacts. Its material and friction, which come from the
        calibration, are the prior means of E* and sigma B.
    design : Design or Surface
        Design with the nominal heights, radii and positions.
    priors : Priors
        Expected errors; default: `Priors()`.
    model : Model, optional
        Model with the contact law of the design's model; for a Surface, `Hertz`, or `Elastic` if a summit has
        no curvature. Default: independent asperities; if the surface has
        a block, asperities that interact through the bonded layer if these make the measured values more
        probable. Adhesive asperities are independent by default. Derivatives with respect to errors of single
        asperities neglect interaction. Derivatives with respect to errors of the entire part are closed forms
        for independent asperities and central differences for interacting asperities.

    Returns
    -------
    Explanation

    Raises
    ------
    InvalidInput
        If an argument has a wrong type, a site is not in the design, or friction forces have no Friction.
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
    usual = contact_of(design.law.model) if isinstance(design, Design) else usual_law(surface)
    tried = _models(model, surface, usual)
    adhesive = contact_of(tried[0]).adhesive
    causes = Causes.of(surface, measured.load, measured.load_sd, expected, forces, adhesive)
    found = {one.name: _solved(Scene(one, causes, measured, friction)) for one in tried}
    evidence = {name: posterior.log_evidence for name, (_, posterior) in found.items()}
    best = max(evidence, key=lambda name: evidence[name])
    sites = design.sites if isinstance(design, Design) else None
    return replace(_explanation(*found[best], expected, evidence), sites=sites)


def _refuse_contacts(measured: MeasuredLaw, count: int) -> None:
    """Raise InvalidInput if the design lacks an asperity, or if the area of a closed contact has no error."""
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
    # interacting adhesive contacts would take too long: each of hundreds of states takes seconds, because the
    # model follows the contacts from the first touch
    if surface.block is None or contact.adhesive:
        return [independent]
    return [independent, with_contact(Interacting(substrate=BondedLayer()), contact)]


def _solved(scene: Scene) -> tuple[Scene, Posterior]:
    """Return the scene with widened priors of outlying heights, and the posterior."""
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
    """Return the explanation of a measured law by one model, from its posterior."""
    causes, mean, at = scene.causes, posterior.mean, posterior.linear
    sd, loads = np.sqrt(np.diag(posterior.covariance)), causes.where["load"]
    common = causes.common
    index = [causes.where[name].start for name in common]
    scale = np.array([causes.sd[name] for name in common])
    part, friction = causes.made(mean), scene.friction
    if friction is not None:
        friction = Friction(part.factor["friction"] * friction.shear_strength, friction.area_ratio)
    gradient = at.gradient
    # effective number of fitted parameters: sum of posterior variances of computed values over measured
    # variances
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
    """Return notes on a posterior that has not converged, and on impossible factors of E* or sigma B."""
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
    """Return the errors of one kind for all asperities."""
    where, prior, scale = causes.where[name], causes.sd[name], causes.scale(name)
    shape = (-1, 2) if name == "position" else (-1,)
    largest = float(ndtri(0.5 + 0.5 * NO_OUTLIER ** (1.0 / len(scale))))
    found, deviation = ((scale * of[where]).reshape(shape) for of in (mean, sd))
    return SingleErrors(name, prior, found, deviation, np.abs(found) > largest * prior)


def _residuals(scene: Scene, residual: FloatArray, mean: FloatArray) -> dict[str, FloatArray]:
    """Return the normalised residuals of each quantity by its name."""
    k, totals = len(scene.causes.load), scene.totals
    result = dict(zip(totals, residual[: k * len(totals)].reshape(-1, k), strict=True))
    row, site, area, _ = scene.closed
    if len(area):
        table = np.full((k, scene.causes.surface.count), np.nan)
        table[row, site] = residual[k * len(totals) :]
        result["asperity_area"] = table
    return {"load": -mean[scene.causes.where["load"]], **result}
