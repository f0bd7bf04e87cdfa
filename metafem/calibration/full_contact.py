"""Shear strength from the friction of a surface with all asperities in contact."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import block_diag

from metafem import _validate as check
from metafem import drawing
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.sheared import proportional
from metafem.calibration.statistics import Verdict, checked_covariance, interval_of, judged
from metafem.contact.elastic import usual_law
from metafem.drawing import calibration
from metafem.errors import InvalidInput, refuse_if
from metafem.material import Friction
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.prediction import equilibrium, friction_law
from metafem.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Relative step of central differences. The error of a difference is about the square of the step, and the
# rounding error 1e-16 over the step.
STEP = 1e-4

# Parameters whose errors affect sigma.
PARAMETERS = ("composite_modulus", "area_ratio", "radius")


def shear_strength(
    law: MeasuredLaw,
    surface: Surface,
    load_min: float,
    *,
    model: Model | None = None,
    covariance: ArrayLike | None = None,
    parameters: Sequence[str] = PARAMETERS[:2],
) -> StrengthFit:
    """Return the shear strength sigma, fitted to friction forces at loads with all asperities in contact.

    At these loads no new contacts form, and the predicted area A0(P) hardly depends on the heights. The fit
    of ``F = sigma B A0(P)`` takes the errors of load and friction force into account and gives sigma B, which
    is divided by B. The relative sensitivity of sigma to E*, ``dlog(sigma)/dlog(E*)``, is about 2/3. The
    sensitivity to B is -1, and the sensitivity to the radius is about -2/3. If E* was calibrated with caps of
    the same radius, E* is proportional to the radius, and the effect of an error of the radius on sigma
    nearly cancels. Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text
    "Model parameter values".

    Parameters
    ----------
    law : MeasuredLaw
        Measured law with friction forces; points below `load_min` are not used.
    surface : Surface
        Designed or measured surface with its E*. Its friction provides the area ratio B; if it has no
        friction, the law provides B.
    load_min : float
        Smallest load that is used [N].
    model : Model, optional
        Model of the contact area; default: independent asperities with the contact law `Hertz`, or `Elastic`
        if a summit has no finite curvature.
    covariance : array_like, (p, p), optional
        Covariance of the `parameters`, in mm, MPa and 1; default: no errors.
    parameters : sequence of str
        Names of the rows of `covariance`: ``radius`` (the mean radius; all radii change by the same factor),
        ``composite_modulus`` and ``area_ratio``; default: the last two. The names from
        `metafem.calibration.joint_covariance` are accepted, and ``shear_strength`` is ignored.

    Returns
    -------
    StrengthFit

    Raises
    ------
    InvalidInput
        If an asperity is open at `load_min` under the model, if fewer than two points are at or above
        `load_min`, if the law has no friction forces, or if the area ratio is unknown.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([[0.1, 0.11]], (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> law = mf.calibration.MeasuredLaw(
    ...     [0.1, 0.2, 0.3], friction_force=[0.127, 0.2, 0.264],
    ...     material=surface.material, friction=mf.Friction(0.4, 0.85),
    ... )
    >>> shear_strength(law, surface, 0.1)
    <StrengthFit: sigma = 0.3987 ± 0.0052 MPa, 3 points>
    """
    check.instance("law", law, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    check.instance("surface", surface, Surface, "a metafem.Surface")
    least = check.number("load_min", load_min, above=0.0)
    solver = Independent(contact=usual_law(surface)) if model is None else model
    names, known = _covariance(covariance, parameters)
    if law.friction_force is None or law.friction_force_sd is None:
        raise InvalidInput("law has no friction forces; sigma needs them")
    friction = surface.friction or law.friction
    if friction is None:
        raise InvalidInput(
            "the area ratio B is not known; give the surface a friction=metafem.Friction(shear_strength, "
            "area_ratio), whose shear strength is not used"
        )
    used = law.load >= least
    few = f"law has {int(used.sum())} points at {{}} or above; sigma needs at least 2"
    refuse_if(used.sum() < 2, few, Given("load_min", least))
    _refuse_open(surface, solver, least)
    load, force, load_sd = law.load[used], law.friction_force[used], law.load_sd[used]
    area, slope = _areas(surface, solver, load)
    area_sd, of_force, force_sd = slope * load_sd, law.errors.of_friction_force, law.friction_force_sd[used]
    # default standard deviations are computed from the fitted force, because the measured force is noisy
    of = of_force if np.allclose(force_sd, of_force(force), rtol=1e-9) else lambda _: force_sd
    points = np.stack([area, force])
    fit = proportional(points, (lambda _: area_sd, of))
    (factor,), ((variance,),), value = fit.parameter, fit.covariance, fit.abscissa[:, 0]
    refuse_if(
        factor <= 0.0,
        f"friction_force is not positive on the whole: sigma B = {factor:.4g} MPa; forces that resist "
        "sliding are positive",
    )
    fitted_sd = of(factor * value)
    square = fitted_sd**2 + (factor * area_sd) ** 2
    residual = (force - factor * area) / np.sqrt(square)
    ratio = float(friction.area_ratio)
    strength = float(factor / ratio)
    measured = float(variance) / ratio**2
    # relative changes of sigma with each parameter, through the areas (weighted as in the fit) or through B
    weight = area / square / (area**2 / square).sum()
    change = {
        "composite_modulus": lambda: float(weight @ (load * slope)) / surface.material.composite_modulus,
        "area_ratio": lambda: -1.0 / ratio,
        "radius": lambda: -float(weight @ _growth(surface, solver, load)) / float(surface.radius.mean()),
    }
    gradient = strength * np.array([change[name]() for name in names])
    jacobian = np.vstack([np.eye(len(names), len(names) + 1), np.append(gradient, 1.0)])
    return StrengthFit(
        shear_strength=strength,
        parameters=(*names, "shear_strength"),
        covariance=jacobian @ block_diag(known, measured) @ jacobian.T,
        measured_sd=measured**0.5,
        load=load,
        friction_force=force,
        area=area,
        area_sd=area_sd,
        friction_force_sd=fitted_sd,
        residual=residual,
        verdict=judged(residual, 1),
        area_ratio=ratio,
    )


def _covariance(
    covariance: ArrayLike | None, parameters: Sequence[str]
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of the parameters that affect sigma, and their covariance."""
    if covariance is None:
        return (), np.zeros((0, 0))
    names = tuple(parameters)
    unknown = set(names) - {*PARAMETERS, "shear_strength"}
    must = f"parameters = {shown(names)} must be different names of {', '.join(PARAMETERS)}"
    refuse_if(unknown or len(set(names)) < len(names), must)
    matrix = checked_covariance(names, covariance)
    rows = [i for i, name in enumerate(names) if name in PARAMETERS]
    return tuple(names[i] for i in rows), matrix[np.ix_(rows, rows)]


def _growth(surface: Surface, model: Model, load: FloatArray) -> FloatArray:
    """Return the derivative of A0 with respect to the logarithm of all radii [mm^2], (k,)."""
    low, high = (
        _areas(surface.replaced(radius=surface.radius * (1.0 + sign * STEP)), model, load)[0]
        for sign in (-1.0, 1.0)
    )
    return (high - low) / (2.0 * STEP)


def _areas(surface: Surface, model: Model, load: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return A0 [mm^2] and dA0/dP [mm^2/N] at loads in any order, (k,) each."""
    wanted = load * (1.0 + STEP * np.array([[-1.0], [0.0], [1.0]]))
    single, places = np.unique(wanted, return_inverse=True)
    low, area, high = friction_law(surface, model, load=single).area[places].reshape(wanted.shape)
    return area, (high - low) / (2.0 * STEP * load)


def _refuse_open(surface: Surface, model: Model, load: float) -> None:
    """Raise InvalidInput if an asperity is open; the message states a sufficient load."""
    opened = int((equilibrium(surface, model, load=load).asperity_area <= 0.0).sum())
    if opened:
        alone = Independent(contact=contact_of(model))
        least = equilibrium(surface, alone, approach=float(np.ptp(surface.height))).load
        unit = 10.0 ** (math.floor(math.log10(least)) - 2)  # unit of the third digit
        raise InvalidInput(
            f"is too small: {opened} of {surface.count} asperities are not in contact at this load; all are "
            "from {.number} on without interaction",
            Given("load_min", math.ceil(least / unit) * unit),
            key="load_min",
            value=load,
        )


@dataclass(frozen=True, eq=False, repr=False)
class StrengthFit(Value):
    """Shear strength from a surface in full contact, with its errors.

    Attributes
    ----------
    shear_strength : float
        Shear strength sigma [MPa].
    parameters : tuple of str
        Names of the rows of `covariance`: the parameters of the call, then ``shear_strength``.
    covariance : ndarray, (p, p)
        Covariance of `parameters`, in mm, MPa and 1.
    measured_sd : float
        Standard deviation of sigma due to the errors of loads and friction forces only [MPa].
    load, friction_force : ndarray, (k,)
        Loads and friction forces of the points that were used [N].
    area : ndarray, (k,)
        Predicted contact area before shear [mm^2].
    area_sd, friction_force_sd : ndarray, (k,)
        Standard deviations of the area due to the errors of the loads [mm^2], and of the friction forces [N].
    residual : ndarray, (k,)
        Residuals over their standard deviations [-].
    verdict : Verdict
        Whether the friction forces are proportional to the predicted areas.
    area_ratio : float
        Area ratio B that was used [-].
    friction : metafem.Friction
    shear_strength_interval : (float, float)
        68 % interval of sigma [MPa].

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(
    ...     0.1, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.4, 0.85)
    ... )
    >>> law = mf.friction_law(surface, load=[0.5, 1.0, 1.5])
    >>> measured = mf.calibration.MeasuredLaw(
    ...     law.load, friction_force=law.friction_force, material=surface.material, friction=surface.friction
    ... )
    >>> mf.calibration.shear_strength(measured, surface, 0.5)
    <StrengthFit: sigma = 0.4 ± 0.0026 MPa, 3 points>
    """

    shear_strength: float
    parameters: tuple[str, ...]
    covariance: FloatArray
    measured_sd: float
    load: FloatArray
    friction_force: FloatArray
    area: FloatArray
    area_sd: FloatArray
    friction_force_sd: FloatArray
    residual: FloatArray
    verdict: Verdict
    area_ratio: float

    def __repr__(self) -> str:
        deviation = float(np.sqrt(self.covariance[-1, -1]))
        return (
            f"<StrengthFit: sigma = {self.shear_strength:.4g} ± {deviation:.2g} MPa, {len(self.load)} points>"
        )

    @property
    def parameter_covariance(self) -> FloatArray:
        """Covariance of the parameters, for `metafem.calibration.joint_covariance`."""
        return self.covariance

    @property
    def friction(self) -> Friction:
        """Friction with the fitted shear strength and the area ratio that was used."""
        return Friction(self.shear_strength, self.area_ratio)

    @property
    def shear_strength_interval(self) -> tuple[float, float]:
        """68 % interval of sigma [MPa]."""
        return interval_of(self.shear_strength, self.covariance[-1, -1])

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw friction forces over predicted areas with error bars and the fitted line, and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.
        """
        ax = drawing.axes(ax)
        points = self.area, self.friction_force, self.area_sd, self.friction_force_sd
        calibration.proportional(ax, *points, self.shear_strength * self.area_ratio)
        ax.set(xlabel="predicted area  A0 [mm²]", ylabel="friction force  F [N]")
        return ax
