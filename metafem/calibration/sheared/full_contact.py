"""Shear strength from the friction of a surface of which every asperity is in contact."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_call
from metafem._given import formatted, shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.sheared.proportional import proportional
from metafem.calibration.sheared.result import WIDTH_68
from metafem.calibration.verdict import Verdict, judged
from metafem.errors import InvalidInput, MetafemError
from metafem.material import Friction
from metafem.models import Independent, Model
from metafem.prediction import equilibrium, friction_law
from metafem.surface import Surface

# Relative step of the load in the derivative dA0/dP: the error of a central difference is its square, and the
# rounding 1e-16 over it.
STEP = 1e-4

# Steps that find the load at which the last asperity comes into contact, for an error alone.
DOUBLINGS, HALVINGS = 10, 12

# Of a factor: one, and one more for a residual.
FEWEST = 2


@dataclass(frozen=True, eq=False, repr=False)
class StrengthFit(Value):
    """Shear strength of a surface in full contact, with its errors.

    Attributes
    ----------
    shear_strength : float
        sigma [MPa].
    covariance : ndarray, (3, 3)
        Covariance of the composite modulus [MPa], the area ratio [-] and the shear strength [MPa], in this
        order; that of the first two is the given one.
    measured_sd : float
        Standard deviation of sigma from the errors of loads and friction forces alone [MPa].
    load, friction_force : ndarray, (k,)
        Measured points that were used [N].
    area : ndarray, (k,)
        Predicted contact area before shear [mm^2].
    residual : ndarray, (k,)
        Residuals over their standard deviations [-].
    verdict : Verdict
        Whether the friction forces are in proportion to the predicted areas.
    area_ratio : float
        The area ratio B that was used [-].
    friction : metafem.Friction
    shear_strength_interval : (float, float)
        68 % interval [MPa].

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
    covariance: FloatArray
    measured_sd: float
    load: FloatArray
    friction_force: FloatArray
    area: FloatArray
    residual: FloatArray
    verdict: Verdict
    area_ratio: float

    def __repr__(self) -> str:
        deviation = float(np.sqrt(self.covariance[2, 2]))
        return (
            f"<StrengthFit: sigma = {self.shear_strength:.4g} ± {deviation:.2g} MPa, {len(self.load)} points>"
        )

    @property
    def friction(self) -> Friction:
        """Friction with the fitted strength and the area ratio that was used."""
        return Friction(self.shear_strength, self.area_ratio)

    @property
    def shear_strength_interval(self) -> tuple[float, float]:
        """68 % interval of sigma [MPa]."""
        half = WIDTH_68 * float(np.sqrt(self.covariance[2, 2]))
        return self.shear_strength - half, self.shear_strength + half


@checked_call
def shear_strength(
    law: MeasuredLaw,
    surface: Surface,
    load_min: float,
    *,
    model: Model | None = None,
    covariance: ArrayLike | None = None,
) -> StrengthFit:
    """Fit the shear strength to friction forces at loads under which all asperities are in contact.

    Under such loads no new contact is formed, and the area A0(P) that the model predicts hardly depends on
    the heights. The factor of ``F = sigma B A0(P)`` is fitted with the errors of load and friction force, and
    divided by B. Errors of E* and B change sigma by ``dlog(sigma)/dlog(E*)``, about 2/3, and by
    ``dlog(sigma)/dlog(B) = -1``. Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234,
    supplementary text "Model parameter values".

    Parameters
    ----------
    law : MeasuredLaw
        With friction forces; points below `load_min` are not used.
    surface : Surface
        The surface, as designed or as measured, with E* and the area ratio B of its friction; if it has no
        friction, B is that of the law.
    load_min : float
        Smallest load that is used [N].
    model : Model, optional
        Default: `Independent()`.
    covariance : array_like, (2, 2), optional
        Covariance of E* [MPa] and B [-], in this order; default: no errors.

    Returns
    -------
    StrengthFit

    Raises
    ------
    InvalidInput
        If the model says that an asperity is not in contact at `load_min`, for fewer than two points above
        it, for a law without friction forces, and if no area ratio is known.

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
    solver = Independent() if model is None else model
    given = _covariance(covariance)
    if law.friction_force is None or law.friction_force_sd is None:
        raise InvalidInput("law has no friction forces; sigma needs them")
    friction = surface.friction or law.friction
    if friction is None:
        raise InvalidInput(
            "the area ratio B is not known; give the surface a friction=metafem.Friction(shear_strength, "
            "area_ratio), whose shear strength is not used"
        )
    used = law.load >= least
    if used.sum() < FEWEST:
        raise InvalidInput(
            f"law has {int(used.sum())} points at load_min = {formatted('load_min', least)} or above; sigma "
            f"needs at least {FEWEST}"
        )
    _refuse_open(surface, solver, least)
    load, force, load_sd = law.load[used], law.friction_force[used], law.load_sd[used]
    area, slope = _areas(surface, solver, load)
    errors, force_sd = law.errors, law.friction_force_sd[used]
    # standard deviations that follow from the force are those at the fitted one, which is not noisy
    follows = np.allclose(force_sd, errors.of_friction_force(force), rtol=1e-9)
    deviation = (
        lambda _: slope * load_sd,
        errors.of_friction_force if follows else lambda _: force_sd,
    )
    (factor,), ((variance,),), value = proportional(np.stack([area, force]), deviation)
    if factor <= 0.0:
        raise InvalidInput(
            f"friction_force is not positive on the whole: sigma B = {factor:.4g} MPa; forces that resist "
            "sliding are positive"
        )
    fitted_sd = errors.of_friction_force(factor * value) if follows else force_sd
    square = fitted_sd**2 + (factor * slope * load_sd) ** 2
    residual = (force - factor * area) / np.sqrt(square)
    strength = factor / friction.area_ratio
    # of E*: the areas at the rescaled loads P/E* change by -P dA0/dP for each relative change
    exponent = float((area * load * slope / square).sum() / (area**2 / square).sum())
    modulus, ratio = surface.material.composite_modulus, friction.area_ratio
    gradient = strength * np.array([exponent / modulus, -1.0 / ratio])
    measured = float(variance) / ratio**2
    whole = np.zeros((3, 3))
    whole[:2, :2] = given
    whole[2, :2] = whole[:2, 2] = given @ gradient
    whole[2, 2] = gradient @ given @ gradient + measured
    return StrengthFit(
        float(strength),
        whole,
        measured**0.5,
        load,
        force,
        area,
        residual,
        judged(residual, 1),
        friction.area_ratio,
    )


def _covariance(given: ArrayLike | None) -> FloatArray:
    """Return the covariance of E* and B."""
    if given is None:
        return np.zeros((2, 2))
    matrix = check.array("covariance", given, shape=(2, 2))
    # a correlation slightly above 1 is rounding
    if matrix[0, 1] != matrix[1, 0] or np.linalg.eigvalsh(matrix)[0] < -1e-12 * matrix.max():
        raise InvalidInput(
            f"covariance = {shown(matrix.tolist())} of E* and B must be symmetric and positive semidefinite"
        )
    return matrix


def _areas(surface: Surface, model: Model, load: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return A0 [mm^2] and dA0/dP [mm^2/N] at loads in any order."""
    wanted = load * (1.0 + STEP * np.array([[-1.0], [0.0], [1.0]]))
    single, places = np.unique(wanted, return_inverse=True)
    low, area, high = friction_law(surface, model, load=single).area[places].reshape(wanted.shape)
    return area, (high - low) / (2.0 * STEP * load)


def _refuse_open(surface: Surface, model: Model, load: float) -> None:
    """Refuse a load at which an asperity is not in contact, and name the one at which all are."""
    opened = _open(surface, model, load)
    if not opened:
        return
    raise InvalidInput(
        f"load_min = {formatted('load_min', load)}: {opened} of {surface.count} asperities are not in "
        f"contact at this load{_all_touch(surface, model, load)}"
    )


def _all_touch(surface: Surface, model: Model, load: float) -> str:
    """Return from which load on all asperities are in contact, in words; empty if the model finds none."""
    low, high = load, load
    try:
        for _ in range(DOUBLINGS):
            low, high = high, 2.0 * high
            if not _open(surface, model, high):
                break
        else:
            return ""
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if _open(surface, model, middle) else (low, middle)
    except MetafemError:  # beyond the range of the contact law
        return ""
    unit = 10.0 ** (math.floor(math.log10(high)) - 2)  # of the third digit
    return f"; all are from {formatted('load_min', math.ceil(high / unit) * unit)} on"


def _open(surface: Surface, model: Model, load: float) -> int:
    """Return the number of asperities that are not in contact at a load."""
    return int((equilibrium(surface, model, load=load).asperity_area <= 0.0).sum())
