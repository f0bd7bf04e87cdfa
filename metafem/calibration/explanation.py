"""The errors of a made part that explain why its measured law differs from the design."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, percent
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.statistics import Verdict
from metafem.contact.elastic import usual_law
from metafem.errors import NotConverged, refuse_if
from metafem.inversion import Design
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.prediction import equilibrium
from metafem.progress import doing
from metafem.surface import STEEPEST, Surface

# Errors that are found, their names and their expected standard deviations: tilt about either axis [rad],
# factor of all heights, E* and sigma B [-], as in the parts of Aymard et al. (2024), and that of each height
# [mm].
EXPECTED = {
    "angle_x": math.radians(0.05),
    "angle_y": math.radians(0.05),
    "height_scale": 0.02,
    "composite_modulus": 0.05,
    "friction": 0.05,
}
NAMES = dict(zip(EXPECTED, ("tilt along x", "tilt along y", "height scale", "E*", "σB"), strict=True))
HEIGHT = 0.9e-3

# Largest errors that are found; without friction forces, the last one is not.
MOST = np.array([STEEPEST, STEEPEST, 0.9, 0.9, 0.9])

# Steps of the fit: the full length at first, and half of it where contacts that open and close make it swing.
# It ends when no error changes by more than ENOUGH of its standard deviation.
SHARES, ENOUGH = (1.0,) * 12 + (0.5,) * 18, 1e-2


@dataclass(frozen=True, eq=False, repr=False)
class Explanation(Value):
    """Errors of a part that explain its measured law, by least squares.

    Attributes
    ----------
    expected, mean, sd : mapping of str to float
        Expected standard deviation, found value and its standard deviation of ``angle_x``, ``angle_y`` [rad],
        ``height_scale``, ``composite_modulus`` and ``friction`` [-].
    deviation : float
        Root mean square deviation of the measured areas (without areas, of the friction forces) from those of
        a part with these errors, over their root mean square [-].
    verdict : Verdict
        Whether the errors explain the values: chi-square of the values and of the errors over their expected
        standard deviations.
    model : Model

    Examples
    --------
    >>> import metafem as mf
    >>> material = mf.Material(1.36)
    >>> design = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=material)
    >>> law = mf.friction_law(design.tilted(0.002, 0.0), load=[0.05, 0.1, 0.2])
    >>> measured = mf.calibration.MeasuredLaw(law.load, area=law.area, material=material)
    >>> list(mf.calibration.explain(measured, design).mean)
    ['angle_x', 'angle_y', 'height_scale', 'composite_modulus']
    """

    expected: Mapping[str, float]
    mean: Mapping[str, float]
    sd: Mapping[str, float]
    deviation: float
    verdict: Verdict
    model: Model

    def __repr__(self) -> str:
        rows = (row(name, self.mean[name], self.sd[name], self.expected[name]) for name in self.mean)
        lines = [f"{name}: {found} (expected {expected})" for name, found, expected in rows]
        return "\n".join([*lines, str(self.verdict)])


@doing("explaining the measured law")
def explain(
    measured: MeasuredLaw,
    design: Design | Surface,
    *,
    model: Model | None = None,
) -> Explanation:
    """Return the errors of a part that explain why its measured law differs from the design.

    The tilt, a common factor of all heights, E* and sigma B are fitted by least squares to friction forces,
    and to the areas of the single contacts or to their sum. The errors count as measured values of 0 with
    their expected standard deviations: 0.05 degrees about either axis, 2 %, 5 % and 5 %. The covariance of
    the measured values includes the errors of the loads and of the single heights, 0.9 um. Values are those
    of the model; their derivatives are those of contacts without interaction, so that each step solves the
    model once. Tarantola, Inverse Problem Theory (SIAM, 2005), doi:10.1137/1.9780898717921, section 3.2.3.

    Parameters
    ----------
    measured : MeasuredLaw
        Its material and friction, from the calibration, provide the expected E* and sigma B.
    design : Design or Surface
    model : Model, optional
        Default: the model of the design; for a Surface, independent asperities.

    Returns
    -------
    Explanation

    Raises
    ------
    InvalidInput
        If an argument is invalid, a site is not in the design, or friction forces have no Friction.
    NotConverged
        If the model has no solution at a load, or the fit does not converge.

    Examples
    --------
    >>> import metafem as mf
    >>> from metafem.calibration import MeasuredLaw, explain
    >>> material = mf.Material(1.36)
    >>> design = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=material)
    >>> softer = mf.friction_law(design, load=np.array([0.1, 0.2]) / 0.95)  # as of a modulus 5 % smaller
    >>> measured = MeasuredLaw([0.1, 0.2], area=softer.area, material=material)
    >>> round(explain(measured, design).mean["composite_modulus"], 2)  # its expected value is 0
    -0.04
    """
    check.instance("measured", measured, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    surface = design.surface if isinstance(design, Design) else design
    check.instance("design", surface, Surface, "a metafem.Design or a metafem.Surface")
    usual = design.law.model if isinstance(design, Design) else Independent(contact=usual_law(surface))
    solver = usual if model is None else checked_model(model)
    friction, by_force = measured.friction or surface.friction, measured.friction_force is not None
    without = "measured friction forces need a design or a measured law with a Friction"
    refuse_if(by_force and friction is None, without)
    last = 0 if measured.site is None else int(measured.site.max())
    refuse_if(last >= surface.count, f"site names asperity {last}; the design has {surface.count}, from 0")
    stress = friction.stress if friction is not None and by_force else 0.0
    count = 5 if by_force else 4
    names, scale = [*EXPECTED][:count], np.array([*EXPECTED.values()])[:count]
    error = np.zeros(count)
    for share in SHARES:
        off, slopes, deviation = _whitened(measured, surface, solver, stress, error)
        covariance = np.linalg.inv(slopes.T @ slopes + np.diag(scale**-2))
        # the errors are measured values of 0
        change, sd = covariance @ (slopes.T @ off - error / scale**2), np.sqrt(np.diagonal(covariance))
        if (np.abs(change) <= ENOUGH * sd).all():
            break
        error = np.clip(error + share * change, -MOST[:count], MOST[:count])
    else:
        raise NotConverged("the fit of the errors that explain the measured law does not converge", error)
    expected, mean, sds = (dict(zip(names, each.tolist(), strict=True)) for each in (scale, error, sd))
    verdict = Verdict(float(off @ off + ((error / scale) ** 2).sum()), len(off))
    return Explanation(expected, mean, sds, deviation, verdict, solver)


def _whitened(
    law: MeasuredLaw, surface: Surface, model: Model, stress: float, error: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return measured minus computed values of a part with errors, and derivatives of the computed ones.

    Both are in standard deviations of the measured values; the third value is the relative deviation (rms) of
    the areas, or of the forces without areas. The derivatives of the areas are those of contacts without
    interaction at a fixed load. `stress` is sigma B, or 0 without friction forces.
    """
    angle_x, angle_y, scale, stiffer, rougher = (*error.tolist(), 0.0)[:5]
    modulus = law.material.composite_modulus * (1.0 + stiffer)
    material = replace(law.material, composite_modulus=modulus)
    part = surface.replaced(height=surface.height * (1.0 + scale), material=material)
    part = part.tilted(angle_x, angle_y) if angle_x or angle_y else part
    area = np.array([equilibrium(part, model, load=p).asperity_area for p in law.load.tolist()])
    contact, size, closed = contact_of(model), np.sqrt(area / math.pi), area > 0.0
    bound, summits, count = contact.bound(part), contact.summits(part), len(law.load)
    with np.errstate(divide="ignore", invalid="ignore"):
        stiffness = np.where(closed, bound.stiffness(size, summits), 0.0)
        slope = np.where(closed, bound.area_slope(size, summits), 0.0)
    total = stiffness.sum(axis=1, keepdims=True)
    by_height = slope[:, :, None] * (np.eye(part.count) - (stiffness / total)[:, None, :])
    by_load = (slope / (modulus * total))[:, :, None]
    shape = np.column_stack([part.position, surface.height])
    by_modulus = -by_load * law.load[:, None, None] / (1.0 + stiffer)
    by_loads = by_load * law.load_sd * np.eye(count)[:, None]
    # the areas, their derivatives by the errors, and their errors by those of heights and loads, side by side
    every = np.concatenate(
        [area[:, :, None], by_height @ shape, by_modulus, HEIGHT * by_height, by_loads], axis=2
    )
    whole = every.sum(axis=1)
    parts: list[tuple[FloatArray, Any, Any]] = []
    if stress:
        parts.append(((1.0 + rougher) * stress * whole, law.friction_force, law.friction_force_sd))
    if law.asperity_area is not None:
        parts.append((every[:, law.site], law.asperity_area, law.asperity_area_sd))
    elif law.area is not None:
        parts.append((whole, law.area, law.area_sd))
    known = [np.isfinite(measured) for _, measured, _ in parts]
    value, own, sd = (
        np.concatenate([each[at] for each, at in zip(of_all, known, strict=True)])
        for of_all in zip(*parts, strict=True)
    )
    # a contact that is found or computed to be open has at least the area error of a touching contact
    least = law.errors.of_open + HEIGHT * float(slope.max())
    sd = np.maximum(sd, np.where(np.minimum(own, value[:, 0]) <= 0.0, least, 0.0))
    by_friction = np.where(np.arange(len(own)) < count, value[:, 0] / (1.0 + rougher), 0.0)
    slopes = np.column_stack([value[:, 1:5], by_friction])[:, : len(error)]
    root = np.linalg.cholesky(np.diag(sd**2) + value[:, 5:] @ value[:, 5:].T)
    off = own - value[:, 0]
    found = np.linalg.solve(root, np.column_stack([off, slopes]))
    last = slice(-known[-1].sum(), None)
    return found[:, 0], found[:, 1:], float(np.linalg.norm(off[last]) / np.linalg.norm(own[last]))


def row(name: str, mean: float, sd: float, expected: float) -> tuple[str, str, str]:
    """Return the name of an error, the found and the expected value as texts.

    Examples
    --------
    >>> row("height_scale", 0.013, 0.001, 0.02)
    ('height scale', '+1.3 % ± 0.1 %', '0 ± 2 %')
    """

    def text(value: float, form: str = ".2g") -> str:
        if name.startswith("angle"):
            return f"{math.degrees(value):{form}}°"
        return percent(value, form)

    return NAMES[name], f"{text(mean, '+.3g')} ± {text(sd)}", f"0 ± {text(expected)}"
