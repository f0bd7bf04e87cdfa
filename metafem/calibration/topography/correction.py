"""Corrected heights for the next part, from the systematic errors of a measured part."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import fdtrc

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import MICROMETRES, Value, percent
from metafem.calibration.topography.made_surface import MadeSurface
from metafem.errors import refuse_if
from metafem.inversion import Design
from metafem.notes import Note, information
from metafem.surface import Surface

# Probability of the F test below which a term is significant. If the true value of a term is 0, the term is
# significant by chance in one of a hundred cases.
SIGNIFICANT = 0.01

# Smallest number of asperities of a regression, and smallest excess of this number over the number of terms.
FEWEST, SPARE = 3, 2

# A note is added if the error of the mean radius exceeds NOTED standard errors plus the fraction RESOLUTION
# of the radius, the resolution of single precision.
NOTED, RESOLUTION = 3.0, 1e-6

# Smallest divisor; it replaces a norm of 0.
_TINY = float(np.finfo(float).tiny)

# Groups of terms of the regression. The terms of a group are used or left out together.
GROUPS = {
    "offset": ("offset",),
    "scale": ("scale",),
    "tilt": ("tilt_x", "tilt_y"),
    "bow": ("bow_xx", "bow_xy", "bow_yy"),
}


@dataclass(frozen=True, eq=False, repr=False)
class Correction(Value):
    """Systematic height errors of a part, and corrected heights for the next part.

    The systematic height error e has the terms offset, ``scale (h - h0)``, ``tilt_x x + tilt_y y`` and
    ``bow_xx x^2 + bow_xy x y + bow_yy y^2``. h is the designed height and h0 its mean; x and y are relative
    to the mean position. All terms except the offset have the mean 0 over the measured asperities. Only
    groups of terms that are significant at 1 % by an F test are used. The remaining height errors are random.

    Attributes
    ----------
    surface : Surface
        Surface of the design with the corrected heights.
    terms : tuple of str
        The significant terms: ``offset`` [mm], ``scale`` [-], ``tilt_x``, ``tilt_y`` [-], ``bow_xx``,
        ``bow_xy``, ``bow_yy`` [1/mm].
    value, value_sd : ndarray, (number of terms,)
        Values of the terms and their standard deviations.
    random_sd : float
        Standard deviation of the random manufacturing errors, without the measurement errors [mm]. Random
        errors cannot be corrected.
    error, spread : float
        Root mean square and standard deviation of the height errors of this part [mm]. The standard deviation
        excludes a common offset, which does not change the friction law.
    expected_error, expected_spread : float
        Expected values of `error` and `spread` for the next part, if its systematic errors are the same [mm].
        They include the random errors and the uncertainty of the terms.
    systematic : ndarray
        Systematic height error of each asperity of the design [mm].
    design : Design or None
        Design with the corrected heights, for `metafem.save`. Its law is the law of the designed heights,
        which the next part is expected to have. None if a Surface was corrected.
    notes : tuple of Note

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(1.36))
    >>> one = np.array([1e-3])
    >>> Correction(surface, ("offset",), one, 0.1 * one, 0.0, 1e-3, 0.0, 1e-4, 0.0, one)
    <Correction: offset; height error 1 um, expected for the next part 0.1 um>
    """

    surface: Surface
    terms: tuple[str, ...]
    value: FloatArray
    value_sd: FloatArray
    random_sd: float
    error: float
    spread: float
    expected_error: float
    expected_spread: float
    systematic: FloatArray
    design: Design | None = None
    notes: tuple[Note, ...] = ()

    def __repr__(self) -> str:
        return (
            f"<Correction: {', '.join(self.terms) or 'nothing significant'}; height error "
            f"{MICROMETRES * self.error:.3g} um, expected for the next part "
            f"{MICROMETRES * self.expected_error:.3g} um>"
        )


def corrected_heights(design: Surface | Design, made: MadeSurface) -> Correction:
    """Return the correction: the heights to order so that the next part has the designed heights.

    An ordered height h' is made with the height ``h' + e(h')``. The corrected height is the h' for which the
    made height equals the designed height. The error e is found by regression of the height errors on the
    designed heights and the positions (see `Correction`). The least significant group of terms is removed
    repeatedly, until all remaining groups are significant.

    Parameters
    ----------
    design : Surface or Design
        Design of the part, with the asperities of `made.design`.
    made : MadeSurface
        Measured part.

    Returns
    -------
    Correction

    Raises
    ------
    InvalidInput
        If `design` is not the design of `made`, or if fewer than three asperities were measured.

    Examples
    --------
    >>> import metafem as mf
    >>> design = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> x = 0.01 * (np.arange(320) - 159.5)
    >>> square = (np.abs(x) - 0.75) ** 2 + (np.abs(x[:, None]) - 0.75) ** 2
    >>> caps = np.sqrt(np.maximum(0.526**2 - square, 0.425**2)) - 0.425  # 0.101 mm high
    >>> made = mf.calibration.measured_surface(caps, 0.01, design)
    >>> correction = mf.calibration.corrected_heights(design, made)
    >>> correction.terms, correction.surface.height.round(4)
    (('offset',), array([0.099, 0.099, 0.099, 0.099]))
    """
    wanted = design.surface if isinstance(design, Design) else design
    check.instance("design", wanted, Surface, "a metafem.Surface or a metafem.Design")
    check.instance("made", made, MadeSurface, "a metafem.calibration.MadeSurface")
    same = wanted.count == made.design.count and all(
        np.array_equal(getattr(wanted, name), getattr(made.design, name)) for name in ("position", "height")
    )
    refuse_if(not same, "design is not the surface that was given to measured_surface; pass made.design")
    count, error = len(made.site), made.height_error
    refuse_if(count < FEWEST, f"made has {count} asperities; the regression of their errors needs {FEWEST}")
    every = _terms(wanted, made.site)
    measured = {group: terms[:, made.site] for group, terms in every.items()}
    groups, left_out = _determined(measured)
    while (worst := _least_significant(measured, groups, error)) is not None:
        groups.remove(worst)
    matrix, value, square = _least_squares(measured, groups, error)
    terms = matrix.shape[1]
    variance = square / (count - terms)
    names = tuple(name for group in groups for name in GROUPS[group])
    columns = [column for group in groups for column in every[group]]
    systematic = sum(
        (each * column for each, column in zip(value, columns, strict=True)), np.zeros(wanted.count)
    )
    # the corrected height h' solves h' + e(h') = h
    scale = dict(zip(names, value.tolist(), strict=True)).get("scale", 0.0)
    surface = wanted.replaced(height=wanted.height - systematic / (1.0 + scale))
    random = max(variance - float((made.height_sd**2).mean()), 0.0)
    # the errors of p terms add p / n of the variance; the error of the offset does not affect the spread
    around = terms - ("offset" in groups)
    return Correction(
        surface=surface,
        terms=names,
        value=value,
        value_sd=np.sqrt(variance * np.diagonal(np.linalg.inv(matrix.T @ matrix))),
        random_sd=math.sqrt(random),
        error=math.sqrt(float((error**2).mean())),
        spread=float(error.std()),
        expected_error=math.sqrt(random + variance * terms / count),
        expected_spread=math.sqrt(random + variance * around / count),
        systematic=systematic,
        design=_renewed(design, surface) if isinstance(design, Design) else None,
        notes=tuple(_notes(made, surface, left_out)),
    )


def _terms(surface: Surface, site: IntArray) -> dict[str, FloatArray]:
    """Return the terms of each group (p, n); all but the offset have the mean 0 over measured sites."""
    x, y = (surface.position - surface.position[site].mean(axis=0)).T
    groups = {"scale": [surface.height], "tilt": [x, y], "bow": [x**2, x * y, y**2]}
    centred = {
        name: np.array([values - values[site].mean() for values in terms]) for name, terms in groups.items()
    }
    return {"offset": np.ones((1, surface.count)), **centred}


def _determined(measured: dict[str, FloatArray]) -> tuple[list[str], list[str]]:
    """Return the groups that the asperities determine with spare degrees of freedom, and the other groups."""
    groups: list[str] = []
    left_out: list[str] = []
    for group in measured:
        matrix = _matrix(measured, [*groups, group])
        rank = np.linalg.matrix_rank(matrix / np.maximum(np.linalg.norm(matrix, axis=0), _TINY))
        enough = rank == matrix.shape[1] <= len(matrix) - SPARE
        (groups if enough else left_out).append(group)
    return groups, left_out


def _least_significant(measured: dict[str, FloatArray], groups: list[str], error: FloatArray) -> str | None:
    """Return the group with the largest probability of the F test, or None if all groups are significant."""
    matrix, _, square = _least_squares(measured, groups, error)
    freedom = len(error) - matrix.shape[1]
    variance = square / freedom
    worst: str | None = None
    probability = SIGNIFICANT
    for group in groups:
        added = _least_squares(measured, [each for each in groups if each != group], error)[2] - square
        count = len(GROUPS[group])
        chance = float(fdtrc(count, freedom, added / count / variance)) if variance > 0.0 else 0.0
        if chance >= probability:
            worst, probability = group, chance
    return worst


def _matrix(measured: dict[str, FloatArray], groups: list[str]) -> FloatArray:
    none = np.empty((0, measured["offset"].size))
    return np.vstack([none, *(measured[group] for group in groups)]).T


def _least_squares(
    measured: dict[str, FloatArray], groups: list[str], error: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return the matrix of the groups' terms, the coefficients, and the sum of the squared residuals."""
    matrix = _matrix(measured, groups)
    value = np.asarray(np.linalg.lstsq(matrix, error, rcond=None)[0]) if matrix.size else np.empty(0)
    return matrix, value, float(((error - matrix @ value) ** 2).sum())


def _notes(made: MadeSurface, surface: Surface, left_out: list[str]) -> Iterator[Note]:
    if left_out:
        yield information(f"the asperities do not determine the terms {', '.join(left_out)}")
    if made.missing.size:
        missing = f"{made.missing.size} of the asperities were not measured"
        yield Note(f"{missing}; the same terms correct their heights")
    designed = float(made.design.radius[made.site].mean())
    weight = made.radius_sd**-2 if made.radius_sd.all() else np.ones(len(made.site))
    off = float((weight * made.radius_error).sum() / weight.sum())
    # radii fitted with a common value do not scatter; their standard error is the error of this value
    spread = float(made.radius_error.std() / math.sqrt(len(made.site)))
    if np.ptp(made.surface.radius) == 0.0:
        spread = max(spread, float(made.radius_sd.min()))
    if abs(off) > NOTED * spread + RESOLUTION * designed:
        larger = f"{abs(off):g} mm {'larger' if off > 0.0 else 'smaller'} than designed"
        remedy = "other heights do not correct that; design the next part with the radius of the tool"
        yield Note(f"the radii are {larger} ({percent(off / designed)}); {remedy}")
    for i in np.flatnonzero(surface.height <= 0.0)[:1].tolist():
        height = f"{surface.height[i]:g}"
        yield Note(f"the corrected height of asperity {i} is {height} mm: it cannot be made")


def _renewed(design: Design, surface: Surface) -> Design:
    note = Note(
        "the heights are those to make next, corrected for the errors of a measured part; the law is that of "
        "the designed heights"
    )
    return replace(design, surface=surface, notes=(*design.notes, note))
