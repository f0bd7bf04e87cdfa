"""The errors of a made part that explain why its measured law differs from the design."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, percent
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.statistics import Verdict, judged
from metafem.contact.elastic import usual_law
from metafem.errors import NotConverged, refuse_if
from metafem.inversion import Design
from metafem.models import Independent, Model
from metafem.models.model import checked_model, contact_of
from metafem.prediction import equilibrium
from metafem.progress import doing
from metafem.surface import STEEPEST, Surface

# Expected standard deviations: tilt about either axis [rad], factor of all heights, E* and sigma B [-],
# as in the parts of Aymard et al. (2024), and that of each height [mm].
EXPECTED = {
    "angle_x": math.radians(0.05),
    "angle_y": math.radians(0.05),
    "height_scale": 0.02,
    "composite_modulus": 0.05,
    "friction": 0.05,
}
HEIGHT = 0.9e-3

# Names of the errors that are found.
NAMES = {
    "angle_x": "tilt along x",
    "angle_y": "tilt along y",
    "height_scale": "height scale",
    "composite_modulus": "E*",
    "friction": "σB",
}

# Largest relative error that is found.
MOST = 0.9

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
    covariance : ndarray, (p, p)
        Covariance of the found errors.
    misfit_design : float
        Chi-square of the measured values without these errors.
    verdict : Verdict
        Whether the errors explain the values: chi-square of the values and of the errors over their expected
        standard deviations.
    surface : Surface
        The part with these errors.
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
    covariance: FloatArray
    misfit_design: float
    verdict: Verdict
    surface: Surface
    model: Model

    def __repr__(self) -> str:
        lines = [
            "{}: {} (expected {})".format(
                *row(name, *(of[name] for of in (self.mean, self.sd, self.expected)))
            )
            for name in self.mean
        ]
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
    friction = measured.friction or surface.friction
    without = "measured friction forces need a design or a measured law with a Friction"
    refuse_if(measured.friction_force is not None and friction is None, without)
    last = 0 if measured.site is None else int(measured.site.max())
    refuse_if(last >= surface.count, f"site names asperity {last}; the design has {surface.count}, from 0")
    stress = friction.stress if friction is not None and measured.friction_force is not None else None
    fit = _Fit(measured, surface, usual if model is None else checked_model(model), stress)
    sd = {name: value for name, value in EXPECTED.items() if name != "friction" or stress is not None}
    scale = np.array(list(sd.values()))
    ends = np.array([STEEPEST if name.startswith("angle") else MOST for name in sd])
    error = np.zeros(len(sd))
    off, slopes = fit.whitened(dict.fromkeys(sd, 0.0))
    misfit = float(off @ off)
    for share in SHARES:
        covariance = np.asarray(np.linalg.inv(slopes.T @ slopes + np.diag(scale**-2)))
        # the errors are measured values of 0
        change = covariance @ (slopes.T @ off - error / scale**2)
        error = np.clip(error + share * change, -ends, ends)
        spread, mean = np.sqrt(np.diagonal(covariance)), dict(zip(sd, error.tolist(), strict=True))
        off, slopes = fit.whitened(mean)
        if (np.abs(change) <= ENOUGH * spread).all():
            break
    else:
        raise NotConverged("the fit of the errors that explain the measured law does not converge", error)
    deviation = dict(zip(sd, spread.tolist(), strict=True))
    verdict = judged(np.append(off, error / scale), len(sd))
    return Explanation(sd, mean, deviation, covariance, misfit, verdict, fit.part(mean), fit.model)


@dataclass(frozen=True, eq=False)
class _Fit:
    """The measured values of a law, and the same values of a part under a model; `stress` is sigma B."""

    law: MeasuredLaw
    surface: Surface
    model: Model
    stress: float | None

    def part(self, error: Mapping[str, float]) -> Surface:
        """Return the part with errors."""
        modulus = self.law.material.composite_modulus * (1.0 + error.get("composite_modulus", 0.0))
        part = self.surface.replaced(
            height=self.surface.height * (1.0 + error.get("height_scale", 0.0)),
            material=replace(self.law.material, composite_modulus=modulus),
        )
        tilt = error.get("angle_x", 0.0), error.get("angle_y", 0.0)
        return part.tilted(*tilt) if any(tilt) else part

    def values(self, area: FloatArray, factor: float) -> FloatArray:
        """Return the values at areas (k, n, ...), or their derivatives at those of the areas."""
        law = self.law
        parts = [] if self.stress is None else [factor * self.stress * area.sum(axis=1)]
        if law.asperity_area is not None:
            parts.append(area[:, law.site][np.isfinite(law.asperity_area)])
        elif law.area is not None:
            parts.append(area.sum(axis=1)[np.isfinite(law.area)])
        return np.concatenate(parts)

    def own(self, suffix: str = "") -> FloatArray:
        """Return the measured values, or their standard deviations for the suffix "_sd"."""
        names = [] if self.stress is None else ["friction_force"]
        names += ["area" if self.law.asperity_area is None else "asperity_area"]
        known = ((getattr(self.law, name), getattr(self.law, name + suffix)) for name in names)
        return np.concatenate([value[np.isfinite(own)] for own, value in known if own is not None])

    def whitened(self, error: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        """Return the differences of the values in standard deviations, and derivatives of those of the part.

        The derivatives of the areas are those of contacts without interaction at a fixed load.
        """
        law, part, factor = self.law, self.part(error), 1.0 + error.get("friction", 0.0)
        loads, contact = law.load, contact_of(self.model)
        area = np.array([equilibrium(part, self.model, load=p).asperity_area for p in loads.tolist()])
        bound, summits, size = contact.bound(part), contact.summits(part), np.sqrt(area / math.pi)
        with np.errstate(divide="ignore", invalid="ignore"):
            stiffness, slope = (
                np.where(area > 0.0, of(size, summits), 0.0) for of in (bound.stiffness, bound.area_slope)
            )
        total = stiffness.sum(axis=1, keepdims=True)
        by_height = slope[:, :, None] * (np.eye(area.shape[1]) - (stiffness / total)[:, None, :])
        by_load = slope / (part.material.composite_modulus * total)
        x, y = part.position.T
        by_error = {
            "angle_x": by_height @ x,
            "angle_y": by_height @ y,
            "height_scale": by_height @ self.surface.height,
            "composite_modulus": -by_load * loads[:, None] / (1.0 + error.get("composite_modulus", 0.0)),
        }
        value = self.values(area, factor)
        slopes = [self.values(by_error.get(name, 0.0 * area), factor) for name in error]
        for name, column in zip(error, slopes, strict=True):
            if name == "friction" and self.stress is not None:
                column[: len(loads)] = value[: len(loads)] / factor
        by_loads = by_load[:, :, None] * law.load_sd * np.eye(len(loads))[:, None]
        change = self.values(np.concatenate([HEIGHT * by_height, by_loads], axis=2), factor)
        # a contact that is found or computed to be open has at least the area error of a touching contact
        least = law.errors.of_open + HEIGHT * float(slope.max())
        sd = np.maximum(self.own("_sd"), np.where(np.minimum(self.own(), value) <= 0.0, least, 0.0))
        root = np.linalg.cholesky(np.diag(sd**2) + change @ change.T)
        right = np.column_stack([self.own() - value, *slopes])
        found = np.linalg.solve(root, right)
        return found[:, 0], found[:, 1:]


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
