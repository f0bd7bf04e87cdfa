"""Area ratio and shear strength from areas and friction forces of sheared contacts; records of one pull."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem import drawing
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration import errors_in_variables as variables
from metafem.calibration.statistics import (
    PAPER,
    MeasurementErrors,
    SingleTest,
    Verdict,
    interval_of,
    judged,
    labels_of,
    scatter,
)
from metafem.drawing import calibration
from metafem.errors import refuse_if
from metafem.material import Friction
from metafem.notes import Note, information

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Excess of B over 1, in standard deviations, above which a fit is refused. One normal error in a hundred is
# larger.
ABOVE_ONE = 2.33

# The two lines: sheared area over area before shear, and friction force over sheared area.
LINES = ("Af = B A0", "F = sigma Af")

# Range of distances after the peak over which the paper averages the sliding friction (page 313) [mm], and
# the rounding error of a difference between decimal displacements, relative to the last displacement.
SLIDING, ROUNDING = (0.1, 0.2), 1e-12

Deviation = Callable[[FloatArray], FloatArray]


def proportional(measured: FloatArray, deviation: Sequence[Deviation]) -> variables.Fit:
    """Return the factors q_j of quantities ``x_j = q_j x_0`` that all have errors, and the x_0 as abscissae.

    `measured` has the quantities x_0, x_1, ... of k points, (..., c, k), nan where not measured; each point
    has two or more. `deviation` returns the standard deviation of each quantity at its values.
    """
    y = np.moveaxis(measured, -2, -1)
    known = np.isfinite(y)
    filled = np.where(known, y, 0.0)
    both = known[..., 1:] & known[..., :-1]
    ratio = (both * filled[..., 1:]).sum(axis=-2) / (both * filled[..., :-1]).sum(axis=-2)
    factor = ratio.cumprod(axis=-1)
    every = np.concatenate([np.ones((*factor.shape[:-1], 1)), factor], axis=-1)[..., None, :]
    start = (filled * every).sum(axis=-1) / (known * every**2).sum(axis=-1)
    # smaller values are noise and would have infinite weights
    least = 1e-6 * start.max(axis=-1, keepdims=True)
    start = np.maximum(start, least)

    def model(q: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        by_x = np.concatenate([np.ones((*q.shape[:-1], 1)), q], axis=-1)[..., None, :, None]
        count = q.shape[-1]
        by_q = x[..., None] * np.eye(count + 1, count, -1)
        return x * by_x[..., 0], by_q, np.broadcast_to(by_x, (*x.shape[:-1], count + 1, 1))

    def of(value: FloatArray) -> FloatArray:
        return np.stack([each(value[..., j]) for j, each in enumerate(deviation)], axis=-1)

    return variables.fit(model, y, of, factor, start[..., None], (least[..., None], np.inf))


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
    notes: tuple[Note, ...] = ()

    # Names of the rows of `covariance`, for `joint_covariance`.
    parameters = ("area_ratio", "shear_strength")

    def __repr__(self) -> str:
        ratio, strength = np.sqrt(np.diagonal(self.covariance))
        return (
            f"<ShearCalibration: B = {self.area_ratio:.4g} ± {ratio:.2g}, "
            f"sigma = {self.shear_strength:.4g} ± {strength:.2g} MPa, {len(self.area_before)} points>"
        )

    @property
    def friction(self) -> Friction:
        """Friction with the fitted area ratio, or 1 if errors make it larger, and the shear strength."""
        return Friction(self.shear_strength, min(self.area_ratio, 1.0))

    @property
    def parameter_covariance(self) -> FloatArray:
        """Covariance of B [-] and sigma [MPa], for `joint_covariance`."""
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
        sheared_sd = errors.of_area(sheared)
        if line == "area":
            points = self.area_before, self.area_sheared, errors.of_area(self.area_fitted), sheared_sd
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
    errors: MeasurementErrors = PAPER,
    test: Sequence[Any] | None = None,
) -> ShearCalibration:
    """Return the area ratio B and the shear strength sigma, fitted to sheared contacts.

    The lines are ``Af = B A0`` and ``F = sigma Af`` with the area A0 before shear, the sheared area Af and
    the friction force F. All three quantities have errors. The true A0 of each point is an unknown of the
    fit; A0, B A0 and sigma B A0 were measured with independent errors, whose standard deviations are computed
    from the fitted values. Both lines contain the sheared area, so B and sigma are correlated (about -0.3
    with the default errors). Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. 2, C
    and D.

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
        Labels of the tests to which the points belong; default: one test.

    Returns
    -------
    ShearCalibration

    Raises
    ------
    InvalidInput
        If an array does not match, an area is not positive, a line has less than two points, or a line falls.

    Examples
    --------
    >>> before = np.array([0.05, 0.1, 0.2, 0.3])
    >>> found = shear(before, [0.043, 0.085, 0.17, 0.254], [0.0155, 0.0316, 0.0632, 0.0941])
    >>> found
    <ShearCalibration: B = 0.8492 ± 0.0077, sigma = 0.3705 ± 0.006 MPa, 4 points>
    """
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    columns = {
        name: _column(name, value)
        for name, value in (
            ("area_before", area_before), ("area_sheared", area_sheared), ("friction_force", friction_force)
        )
    }  # fmt: skip
    counts = {name: len(column) for name, column in columns.items()}
    for name, count in counts.items():
        first = counts["area_before"]
        refuse_if(count != first, f"{name} has {count} entries; area_before has {first}")
    points = np.array([*columns.values()])
    labels = np.array(labels_of(test, points.shape[1]))
    known = np.isfinite(points)
    for pair, line, what in zip((known[:2], known[1:]), LINES, ("B", "sigma"), strict=True):
        few = int(pair.all(axis=0).sum())
        refuse_if(few < 2, f"{what} needs at least 2 points of {line}, and {few} have both quantities")
    found = _fitted(points, errors)
    _refuse_impossible(found)
    names = list(dict.fromkeys(labels.tolist()))
    several = names if len(names) > 1 else []
    tests = tuple(
        SingleTest(name, int((labels == name).sum()), *_of_test(points[:, labels == name], errors))
        for name in several
    )
    found = replace(found, tests=tests, heterogeneity=scatter(tests))
    return replace(found, notes=tuple(_notes(found)))


def _column(name: str, value: ArrayLike) -> FloatArray:
    """Return checked forces (k,), or positive areas (k,) summed over contacts; nan where not measured."""
    if name == "friction_force":
        return check.array_with_gaps(name, value, shape=(None,))
    entries = check.array_with_gaps(name, value, shape=(None,) * (2 if check.depth(value) > 1 else 1))
    without = "must be greater than 0; leave out points without contact"
    check.refuse_entries(name, entries, entries <= 0.0, without)
    return entries if entries.ndim == 1 else np.asarray(entries.sum(axis=1))


def parameters(points: FloatArray, errors: MeasurementErrors) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return B and sigma (..., 2), their covariance (..., 2, 2) and A0 (..., k) for points (..., 3, k)."""
    fit = proportional(points, (errors.of_area, errors.of_area, errors.of_friction_force))
    ratio, product = fit.parameter[..., 0], fit.parameter[..., 1]
    strength = product / ratio  # the second factor is sigma B
    jacobian = np.zeros((*ratio.shape, 2, 2))
    jacobian[..., 0, 0], jacobian[..., 1, 0], jacobian[..., 1, 1] = 1.0, -strength / ratio, 1.0 / ratio
    covariance = jacobian @ fit.covariance @ np.swapaxes(jacobian, -1, -2)
    # make the matrix exactly symmetric
    covariance = 0.5 * (covariance + np.swapaxes(covariance, -1, -2))
    return np.stack([ratio, strength], axis=-1), covariance, fit.abscissa[..., 0]


def _fitted(points: FloatArray, errors: MeasurementErrors) -> ShearCalibration:
    """Return the fit to points (3, k); a point with a single quantity has no fitted area."""
    used = np.isfinite(points).sum(axis=0) >= 2
    value = np.full(points.shape[1], np.nan)
    found, covariance, value[used] = parameters(points[:, used], errors)
    ratio, strength = found.tolist()
    before, sheared, force = points
    before_sd, sheared_sd = errors.of_area(value), errors.of_area(ratio * value)
    force_sd = errors.of_friction_force(strength * ratio * value)
    residual = (
        (sheared - ratio * before) / np.hypot(sheared_sd, ratio * before_sd),
        (force - strength * sheared) / np.hypot(force_sd, strength * sheared_sd),
    )
    verdicts = [judged(off, parameters=1) for off in residual]
    return ShearCalibration(
        *(ratio, strength, covariance, before, sheared, force, value),
        *(residual[0], residual[1], verdicts[0], verdicts[1], errors),
    )


def _of_test(points: FloatArray, errors: MeasurementErrors) -> tuple[FloatArray, FloatArray]:
    """Return B and sigma (2,) and their covariance (2, 2) of one test; nan for a line without points."""
    known = np.isfinite(points)
    pairs = known[:2].all(axis=0), known[1:].all(axis=0)
    if pairs[0].any() and pairs[1].any():
        return parameters(points[:, known.sum(axis=0) >= 2], errors)[:2]
    value, covariance = np.full(2, np.nan), np.full((2, 2), np.nan)
    deviation = errors.of_area, errors.of_area, errors.of_friction_force
    for i, pair in enumerate(pairs):
        if pair.any():
            fit = proportional(points[i : i + 2, pair], deviation[i : i + 2])
            value[i], covariance[i, i] = fit.parameter[0], fit.covariance[0, 0]
    return value, covariance


def _refuse_impossible(found: ShearCalibration) -> None:
    """Raise InvalidInput for factors that cannot be, or for a line that falls and does not fit."""
    sigma = f"friction_force is not positive on the whole: sigma = {found.shear_strength:.4g} MPa; forces"
    refuse_if(found.shear_strength <= 0.0, f"{sigma} that resist sliding are positive")
    columns = "area_before", "area_sheared", "friction_force"
    verdicts = found.area_verdict, found.friction_verdict
    for first, second, line, verdict in zip(columns, columns[1:], LINES, verdicts, strict=False):
        x, y = getattr(found, first), getattr(found, second)
        known = np.isfinite(x) & np.isfinite(y)
        apart = x[known] - x[known].mean()
        slope = float((apart * y[known]).sum()) / (float(apart @ apart) or 1.0)
        refuse_if(
            slope < 0.0 and not verdict.fits,
            f"{second} decreases with {first} (slope {slope:.3g}), which contradicts {line}; check the "
            "columns and their units",
        )
    ratio, sd = found.area_ratio, float(np.sqrt(found.covariance[0, 0]))
    refuse_if(
        ratio > 1.0 + ABOVE_ONE * sd,
        f"area_ratio = {ratio:.4g} ± {sd:.2g} is above 1, but contacts shrink under shear; check that "
        "area_before and area_sheared are not exchanged",
    )


def _notes(found: ShearCalibration) -> Iterator[Note]:
    """Return notes on lines that do not fit, on tests that differ, and on points that lack a quantity."""
    for line, verdict in zip(LINES, (found.area_verdict, found.friction_verdict), strict=True):
        if not verdict.fits:
            yield verdict.note(f"{line} does not fit")
    if found.heterogeneity is not None and not found.heterogeneity.fits:
        yield found.heterogeneity.note("the tests differ")
    unused, count = int(np.isnan(found.area_fitted).sum()), len(found.area_fitted)
    if unused:
        yield information(f"{unused} of {count} points hold less than two quantities and are not used")


def at_peak(displacement: ArrayLike, friction_force: ArrayLike, values: ArrayLike | None = None) -> float:
    """Return the largest friction force of a record [N], or other values at the displacement of this peak.

    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text "Mechanical
    testing".

    Parameters
    ----------
    displacement, friction_force : array_like, (m,)
        Tangential displacement [mm], not decreasing, and force [N], positive if it resists sliding.
    values : array_like, (m,), optional
        Values to interpolate at the peak, such as contact areas, nan between the frames of the camera;
        default: the friction forces.

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the record has no peak, or no values on both sides of it.

    Examples
    --------
    >>> x = np.linspace(0.0, 0.5, 51)
    >>> force = 0.2 * x / (x**2 + 0.01)
    >>> round(at_peak(x, force), 3), round(at_peak(x, force, 0.1 - 0.02 * np.minimum(x / 0.1, 1.0)), 3)
    (1.0, 0.08)
    """
    x, found, peak = _record(displacement, friction_force, values)
    frames = np.flatnonzero(np.isfinite(found))
    beside = frames.size > 0 and frames[0] <= peak <= frames[-1]
    no_frame = "has no frame on both sides of the peak at displacement {.number}"
    refuse_if(not beside, no_frame, Given("displacement", x[peak]), key="values")
    # interpolate over the entries, which are equidistant in time; displacements may repeat
    return float(np.interp(peak, frames, found[frames]))


def over_plateau(
    displacement: ArrayLike, friction_force: ArrayLike, values: ArrayLike | None = None
) -> float:
    """Return the mean friction force from 100 to 200 um after the peak [N], or the mean of other values.

    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text "Applying the
    design strategy to the sliding friction force".

    Parameters
    ----------
    displacement, friction_force : array_like, (m,)
        As of `at_peak`; the record must end 200 um after the peak or later.
    values : array_like, (m,), optional
        Values to average, such as contact areas; default: the friction forces.

    Returns
    -------
    float

    Examples
    --------
    >>> x = np.linspace(0.0, 0.5, 51)
    >>> round(over_plateau(x, np.minimum(x / 0.1, 1.0 - 0.2 * (x > 0.12))), 3)
    0.8
    """
    x, found, peak = _record(displacement, friction_force, values)
    after, rounding = x - x[peak], ROUNDING * x[-1]
    low, high = SLIDING
    last, top, far = (Given("displacement", end) for end in (after[-1], x[peak], high))
    early = "ends {.number} after the peak at {.number}; sliding friction needs {.number}"
    refuse_if(after[-1] < high - rounding, early, last, top, far, key="displacement")
    sliding = (after >= low - rounding) & (after <= high + rounding) & np.isfinite(found)
    few = "has no entry between {.number} and {.number} after the peak"
    refuse_if(not sliding.any(), few, *(Given("displacement", end) for end in SLIDING), key="values")
    return float(found[sliding].mean())


def _record(
    displacement: ArrayLike, friction_force: ArrayLike, values: ArrayLike | None
) -> tuple[FloatArray, FloatArray, int]:
    """Return the checked displacements and values, and the index of the largest force."""
    x = check.array("displacement", displacement, shape=(None,))
    force = check.array("friction_force", friction_force, shape=(len(x),))
    one_way = "is less than the one before; give one pull in one direction"
    check.refuse_entries("displacement", x, np.diff(x, prepend=x[0]) < 0.0, one_way)
    peak = int(force.argmax())
    at, most = Given("displacement", x[peak]), Given("friction_force", force[peak])
    least = "is at most {.number}; forces that resist sliding are positive"
    refuse_if(force[peak] <= 0.0, least, most, key="friction_force")
    end = {0: "first", len(x) - 1: "last"}.get(peak)
    none = (
        f"is largest at the {end} entry, at displacement {{.number}}: the record has no peak; begin it before"
    )
    refuse_if(end, f"{none} the contact is sheared, and shear farther", at, key="friction_force")
    return x, force if values is None else check.array_with_gaps("values", values, shape=(len(x),)), peak
