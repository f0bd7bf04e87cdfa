"""Fit of the area ratio and the shear strength to areas and friction forces of sheared contacts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem import drawing
from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.bounded_interval import interval_of
from metafem.calibration.covariance import propagated
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.sheared.proportional import proportional
from metafem.calibration.sheared.record import measured_or_nan
from metafem.calibration.verdict import SingleTest, Verdict, heterogeneity, judged, labels_of
from metafem.drawing import calibration
from metafem.errors import refuse_if
from metafem.material import Friction
from metafem.notes import Note, information

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Names of the quantities that a point consists of.
NAMES = ("area_before", "area_sheared", "friction_force")

# Excess of B over 1, in standard deviations, above which a note is added. One normal error in a hundred is
# larger.
ABOVE_ONE = 2.33

# Smallest number of points of a line through the origin: one for the factor and one for a residual.
FEWEST = 2

# The two lines: sheared area over area before shear, and friction force over sheared area.
LINES = ("Af = B A0", "F = sigma Af")

DEFAULT_ERRORS = MeasurementErrors()


@dataclass(frozen=True, eq=False, repr=False)
class ShearCalibration(Value):
    """Area ratio B and shear strength sigma of sheared contacts, with their errors.

    Attributes
    ----------
    area_ratio, shear_strength : float
        Area ratio B [-] and shear strength sigma [MPa].
    covariance : ndarray, (2, 2)
        Covariance of B and sigma, in this order. They are correlated because both depend on the sheared area.
    area_before, area_sheared, friction_force : ndarray, (k,)
        Measured areas before and after shear [mm^2], and friction forces [N]; nan for values that were not
        measured.
    area_fitted : ndarray, (k,)
        Fitted areas before shear [mm^2].
    area_residual, friction_residual : ndarray, (k,)
        Distances of the points from the lines ``Af = B A0`` and ``F = sigma Af`` over their standard
        deviations [-]; nan for points that lack a quantity of the line.
    area_verdict, friction_verdict : Verdict
        Verdicts on whether each line fits the points.
    errors : MeasurementErrors
        Standard deviations of the measured quantities.
    tests : tuple of SingleTest
        B and sigma of each test if there are several tests; nan for a value that the test does not determine.
    heterogeneity : Verdict or None
        Whether the tests agree; None for a single test.
    notes : tuple of Note
    friction : metafem.Friction
    area_ratio_interval, shear_strength_interval : (float, float)
        68 % intervals, nowhere negative.

    Examples
    --------
    >>> from metafem.calibration import shear
    >>> before = np.array([0.1, 0.2, 0.3])
    >>> found = shear(before, 0.85 * before, 0.3145 * before)
    >>> round(found.area_ratio, 6), round(found.friction.shear_strength, 6)
    (0.85, 0.37)
    """

    area_ratio: float
    shear_strength: float
    covariance: FloatArray
    area_before: FloatArray
    area_sheared: FloatArray
    friction_force: FloatArray
    area_fitted: FloatArray
    area_residual: FloatArray
    friction_residual: FloatArray
    area_verdict: Verdict
    friction_verdict: Verdict
    errors: MeasurementErrors
    tests: tuple[SingleTest, ...] = ()
    heterogeneity: Verdict | None = None
    notes: tuple[Note, ...] = field(default=())

    def __repr__(self) -> str:
        ratio, strength = np.sqrt(np.diagonal(self.covariance))
        return (
            f"<ShearCalibration: B = {self.area_ratio:.4g} ± {ratio:.2g}, "
            f"sigma = {self.shear_strength:.4g} ± {strength:.2g} MPa, {len(self.area_before)} points>"
        )

    @property
    def friction(self) -> Friction:
        """Friction with the fitted area ratio and shear strength."""
        return Friction(self.shear_strength, self.area_ratio)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the rows of `parameter_covariance`, for `metafem.studies.uncertainty`."""
        return ("area_ratio", "shear_strength")

    @property
    def parameter_covariance(self) -> FloatArray:
        """Covariance of B [-] and sigma [MPa]."""
        return self.covariance

    @property
    def area_ratio_interval(self) -> tuple[float, float]:
        """68 % interval of B [-]."""
        return interval_of(self.area_ratio, self.covariance[0, 0])

    @property
    def shear_strength_interval(self) -> tuple[float, float]:
        """68 % interval of sigma [MPa]."""
        return interval_of(self.shear_strength, self.covariance[1, 1])

    def plot(self, ax: Axes | None = None, line: Literal["area", "friction"] = "friction") -> Axes:
        """Draw one line and its points with error bars, and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.
        line : {"area", "friction"}
            Which line to draw: sheared area over area before shear ("area"), or friction force over sheared
            area ("friction"); default: "friction".

        Examples
        --------
        >>> from metafem.calibration import shear
        >>> before = np.array([0.1, 0.2, 0.3])
        >>> shear(before, 0.85 * before, 0.3145 * before).plot().get_xlabel()
        'sheared area  Af [mm²]'
        """
        refuse_if(line not in ("area", "friction"), f'line = {shown(line)} must be "area" or "friction"')
        ax, errors, sheared = drawing.axes(ax), self.errors, self.area_ratio * self.area_fitted
        before_sd, sheared_sd = errors.of_area(self.area_fitted), errors.of_area(sheared)
        if line == "area":
            points = self.area_before, self.area_sheared, before_sd, sheared_sd
            calibration.proportional(ax, *points, self.area_ratio)
            ax.set(xlabel="area before shear  A0 [mm²]", ylabel="sheared area  Af [mm²]")
        else:
            force_sd = errors.of_friction_force(self.shear_strength * sheared)
            points = self.area_sheared, self.friction_force, sheared_sd, force_sd
            calibration.proportional(ax, *points, self.shear_strength)
            ax.set(xlabel="sheared area  Af [mm²]", ylabel="friction force  F [N]")
        return ax


def shear(
    area_before: ArrayLike,
    area_sheared: ArrayLike,
    friction_force: ArrayLike,
    *,
    errors: MeasurementErrors = DEFAULT_ERRORS,
    test: Sequence[Any] | None = None,
) -> ShearCalibration:
    """Return the area ratio B and the shear strength sigma, fitted to sheared contacts.

    The lines are ``Af = B A0`` and ``F = sigma Af`` with the area A0 before shear, the sheared area Af and
    the friction force F. All three quantities have errors. The true A0 of each point is an unknown of the
    fit; A0, B A0 and sigma B A0 were measured with independent errors, whose standard deviations are computed
    from the fitted values. Both lines contain the sheared area, so B and sigma are correlated (about -0.3
    with the default errors). Two separate fits give nearly equal values and errors, but no covariance. The
    error of sigma B computed from them is too large. Aymard et al., Science 383, 200 (2024),
    doi:10.1126/science.adk4234, Fig. 2, C and D.

    The data may be measured at static friction or during sliding, but friction force and sheared area must be
    measured at the same instant.

    Parameters
    ----------
    area_before, area_sheared : array_like, (k,) or (k, n)
        Contact areas A0 before shear and Af at the friction force [mm^2], positive; nan if not measured.
        Total areas (k,), or areas of n contacts (k, n), which are summed.
    friction_force : array_like, (k,)
        Total friction forces F of these contacts [N]; nan if not measured.
    errors : MeasurementErrors
        Standard deviations of the measured quantities. The error of a total area does not depend on the
        number of contacts.
    test : sequence, (k,), optional
        Label of each point's test; default: one test.

    Returns
    -------
    ShearCalibration

    Raises
    ------
    InvalidInput
        If an area is not positive, the lengths of the arrays differ, a line has fewer than two points, or the
        friction force does not grow with the area.

    Examples
    --------
    >>> before = np.array([0.05, 0.1, 0.2, 0.3])
    >>> found = shear(before, [0.043, 0.085, 0.17, 0.254], [0.0155, 0.0316, 0.0632, 0.0941])
    >>> found
    <ShearCalibration: B = 0.8492 ± 0.0077, sigma = 0.3705 ± 0.006 MPa, 4 points>
    """
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    points = _points(area_before, area_sheared, friction_force)
    names = labels_of(test, points.shape[1])
    known = np.isfinite(points)
    for line, first, second in (("B", 0, 1), ("sigma", 1, 2)):
        number = int((known[first] & known[second]).sum())
        needed = f"{line} needs at least {FEWEST} points with {NAMES[first]} and {NAMES[second]}"
        refuse_if(number < FEWEST, f"{needed}; there are {number}")
    found = fitted(points, errors)
    _refuse_contradiction(found)
    tests = fitted_tests(points, names, errors) if len(set(names)) > 1 else ()
    compared = heterogeneity(tests) if tests else None
    found = replace(found, tests=tests, heterogeneity=compared)
    return replace(found, notes=tuple(_notes(found)))


def _points(*quantities: ArrayLike) -> FloatArray:
    """Return the measured quantities (3, k); areas of several contacts are summed."""
    columns = [measured_or_nan(name, value) for name, value in zip(NAMES, quantities, strict=True)]
    lengths = ", ".join(f"{name} has {len(column)}" for name, column in zip(NAMES, columns, strict=True))
    alike = len({len(column) for column in columns}) == 1
    refuse_if(not alike, f"{lengths} points; all must have the same number")
    return np.stack(columns)


def _refuse_contradiction(found: ShearCalibration) -> None:
    """Raise InvalidInput if sigma is not positive, or if a line through the points falls significantly."""
    strength, names = found.shear_strength, zip(NAMES, NAMES[1:], LINES, strict=False)
    refuse_if(
        strength <= 0.0,
        f"friction_force is not positive on the whole: sigma = {strength:.4g} MPa; forces that resist "
        "sliding are positive",
    )
    for (first, second, line), verdict in zip(
        names, (found.area_verdict, found.friction_verdict), strict=True
    ):
        x, y = getattr(found, first), getattr(found, second)
        known = np.isfinite(x) & np.isfinite(y)
        apart = x[known] - x[known].mean()
        slope = float((apart * y[known]).sum())
        refuse_if(
            slope < 0.0 and not verdict.fits,
            f"{second} decreases with {first} (slope {slope / (apart @ apart or 1.0):.3g}), which "
            f"contradicts {line}; check the columns and their units",
        )


def _notes(found: ShearCalibration) -> Iterator[Note]:
    """Return notes on lines that do not fit, on tests that differ, and on points that lack a quantity."""
    for line, verdict in zip(LINES, (found.area_verdict, found.friction_verdict), strict=True):
        if not verdict.fits:
            yield verdict.note(f"{line} does not fit")
    ratio, sd = found.area_ratio, np.sqrt(found.covariance[0, 0])
    if ratio > 1.0 + ABOVE_ONE * sd:
        yield Note(
            f"B = {ratio:.4g} is above 1 by {(ratio - 1.0) / sd:.2g} standard deviations, but the areas "
            "of soft contacts shrink under shear; compare area_before and area_sheared, and "
            "check that they are not exchanged"
        )
    if found.heterogeneity is not None and not found.heterogeneity.fits:
        yield found.heterogeneity.note("the tests differ")
    unused, count = int(np.isnan(found.area_fitted).sum()), len(found.area_fitted)
    if unused:
        yield information(f"{unused} of {count} points hold less than two quantities and are not used")


def parameters(points: FloatArray, errors: MeasurementErrors) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return B and sigma (..., 2), their covariance (..., 2, 2) and A0 (..., k) for points (..., 3, k)."""
    deviation = (errors.of_area, errors.of_area, errors.of_friction_force)
    factor, covariance, value = proportional(points, deviation)
    ratio, strength = factor[..., 0], factor[..., 1] / factor[..., 0]  # the second factor is sigma B
    covariance = propagated(covariance, (1.0, 0.0), (-strength / ratio, 1.0 / ratio))
    # make the matrix exactly symmetric
    covariance = 0.5 * (covariance + np.swapaxes(covariance, -1, -2))
    return np.stack([ratio, strength], axis=-1), covariance, value


def fitted(points: FloatArray, errors: MeasurementErrors) -> ShearCalibration:
    """Return the fit to points (3, k); a point with a single quantity has no fitted area."""
    used = np.isfinite(points).sum(axis=0) >= 2
    value = np.full(points.shape[1], np.nan)
    found, covariance, value[used] = parameters(points[:, used], errors)
    ratio, strength = found
    before, sheared, force = points
    before_sd, sheared_sd = errors.of_area(value), errors.of_area(ratio * value)
    force_sd = errors.of_friction_force(strength * ratio * value)
    scale = np.hypot(sheared_sd, ratio * before_sd), np.hypot(force_sd, strength * sheared_sd)
    residual = (sheared - ratio * before) / scale[0], (force - strength * sheared) / scale[1]
    verdicts = [judged(off[np.isfinite(off)], parameters=1) for off in residual]
    return ShearCalibration(
        area_ratio=float(ratio),
        shear_strength=float(strength),
        covariance=covariance,
        area_before=before,
        area_sheared=sheared,
        friction_force=force,
        area_fitted=value,
        area_residual=residual[0],
        friction_residual=residual[1],
        area_verdict=verdicts[0],
        friction_verdict=verdicts[1],
        errors=errors,
    )


def fitted_tests(
    points: FloatArray, test: Sequence[str], errors: MeasurementErrors
) -> tuple[SingleTest, ...]:
    """Return one fit for each test."""
    own = {name: points[:, np.array([each == name for each in test])] for name in dict.fromkeys(test)}
    return tuple(SingleTest(name, part.shape[1], *_of_known(part, errors)) for name, part in own.items())


def _of_known(points: FloatArray, errors: MeasurementErrors) -> tuple[FloatArray, FloatArray]:
    """Return B and sigma (2,) and their covariance (2, 2); nan for a line without points."""
    known = np.isfinite(points)
    pairs = known[:2].all(axis=0), known[1:].all(axis=0)
    if pairs[0].any() and pairs[1].any():
        return parameters(points[:, known.sum(axis=0) >= 2], errors)[:2]
    value, covariance = np.full(2, np.nan), np.full((2, 2), np.nan)
    deviation = errors.of_area, errors.of_area, errors.of_friction_force
    for i, pair in enumerate(pairs):
        if pair.any():
            (value[i],), ((covariance[i, i],),), _ = proportional(
                points[i : i + 2, pair], deviation[i : i + 2]
            )
    return value, covariance
