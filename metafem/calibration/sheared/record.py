"""Records of shear tests: static friction, sliding friction and the corresponding contact areas."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray
from metafem._values import Value, span
from metafem.errors import refuse_if
from metafem.notes import Note, counted, information

# Range of distances after the peak over which the paper averages the sliding friction (page 313) [mm].
SLIDING = (0.1, 0.2)

# Largest share of the peak force at which an area counts as measured before shear. The area decreases with
# the square of the force, by 10 to 15 % at the peak (Fig. 2A of the paper), so by less than 0.2 % at a tenth
# of the peak force.
UNSHEARED = 0.1

# Smallest height of a peak above the sliding friction, in standard deviations of the noise. The largest of
# 1,000 noise values is usually smaller.
DISTINCT = 4.0


# Rounding error of a difference between decimal displacements, relative to the last displacement.
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False, repr=False)
class ShearRecord(Value):
    """Static and sliding friction from the record of one shear test.

    Attributes
    ----------
    static_force, sliding_force : float
        Largest friction force, and mean friction force over the sliding range [N].
    noise : float
        Standard deviation of the friction force about a straight line over the sliding range [N]. If m noisy
        values are near the peak, the largest is too high by about ``noise sqrt(2 ln m)``.
    peak_displacement : float
        Displacement at the largest friction force [mm].
    sliding_range : (float, float)
        Range of distances after the peak over which sliding friction is averaged [mm].
    area_before, static_area, sliding_area : float or None
        Contact areas before shear and at the peak, and mean contact area over the sliding range [mm^2]; None
        if areas were not measured.
    displacement, friction_force : ndarray, (m,)
        Recorded displacements [mm] and friction forces [N].
    area : ndarray, (m,), or None
        Contact areas [mm^2]; nan for entries without an image.
    notes : tuple of Note

    Examples
    --------
    >>> displacement = np.linspace(0.0, 0.5, 51)
    >>> found = shear_record(displacement, np.minimum(displacement / 0.1, 1.0 - 0.2 * (displacement > 0.12)))
    >>> found
    <ShearRecord: static 1 N at 0.1 mm, sliding 0.8 N, no areas, no notes>
    """

    static_force: float
    sliding_force: float
    noise: float
    peak_displacement: float
    sliding_range: tuple[float, float]
    displacement: FloatArray
    friction_force: FloatArray
    area: FloatArray | None = None
    area_before: float | None = None
    static_area: float | None = None
    sliding_area: float | None = None
    notes: tuple[Note, ...] = ()

    def __repr__(self) -> str:
        areas = "no areas" if self.area is None else f"area {span(self.area[np.isfinite(self.area)], 'mm^2')}"
        return (
            f"<ShearRecord: static {self.static_force:.4g} N at {self.peak_displacement:.4g} mm, "
            f"sliding {self.sliding_force:.4g} N, {areas}, {counted(self.notes)}>"
        )


def shear_record(
    displacement: ArrayLike,
    friction_force: ArrayLike,
    area: ArrayLike | None = None,
    *,
    sliding_range: tuple[float, float] = SLIDING,
) -> ShearRecord:
    """Return static and sliding friction from the record of a shear test, and the areas of contact.

    The static friction force is the largest force of the record. The sliding friction force is the mean over
    a range of distances after this peak. The static area is interpolated between the frames before and after
    the peak, and the sliding area is the mean of the frames in the range. The area before shear is the area
    in the first frame. Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary
    text "Mechanical testing" and "Applying the design strategy to the sliding friction force".

    Parameters
    ----------
    displacement : array_like, (m,)
        Tangential displacement [mm], not decreasing.
    friction_force : array_like, (m,)
        Tangential force [N], positive if it resists sliding.
    area : array_like, (m,) or (m, n), optional
        Contact area at the same instants [mm^2], nan between the frames; n columns are summed.
    sliding_range : (float, float)
        Range of distances after the peak over which sliding friction is averaged [mm]; default: (0.1, 0.2),
        as in the paper.

    Returns
    -------
    ShearRecord

    Raises
    ------
    InvalidInput
        If the first or the last force is the largest, so that there is no peak, if the record ends before the
        sliding range ends or has fewer than two entries in this range, or if areas are missing.

    Examples
    --------
    >>> x = np.linspace(0.0, 0.5, 51)
    >>> found = shear_record(x, 0.2 * x / (x**2 + 0.01), 0.1 - 0.02 * np.minimum(x / 0.1, 1.0))
    >>> round(found.static_force, 3), round(found.static_area, 3), round(found.area_before, 3)
    (1.0, 0.08, 0.1)
    """
    x = check.array("displacement", displacement, shape=(None,))
    force = check.array("friction_force", friction_force, shape=(len(x),))
    low, high = check.array("sliding_range", sliding_range, shape=(2,)).tolist()
    ends = f"sliding_range = ({low:g}, {high:g}) must increase and not begin before the peak"
    refuse_if(not 0.0 <= low < high, ends)
    back = np.diff(x, prepend=x[0]) < 0.0
    check.refuse_entries(
        "displacement", x, back, "is less than the one before; give one pull in one direction"
    )
    peak = int(force.argmax())
    _refuse_without_peak(x, force, peak)
    after = x - x[peak]
    rounding = ROUNDING * x[-1]
    last, top, near, far = (Given("displacement", end) for end in (after[-1], x[peak], low, high))
    early = "the record ends {.number} after the peak at displacement {.number}"
    refuse_if(after[-1] < high - rounding, f"{early}; the sliding range needs {{.number}}", last, top, far)
    sliding = (after >= low - rounding) & (after <= high + rounding)
    count = int(sliding.sum())
    refuse_if(
        count < 2,
        f"the record has {count} entries between {{.number}} and {{.number}} after the peak; sliding "
        "friction needs at least 2; widen sliding_range",
        near,
        far,
    )
    mean, noise = float(force[sliding].mean()), _noise(x[sliding], force[sliding])
    notes = []
    if force[peak] - mean <= DISTINCT * noise:
        notes.append(
            Note(
                f"the largest force, {force[peak]:.4g} N, is not above the mean of sliding, {mean:.4g} N, by "
                f"more than {DISTINCT:g} times the noise of {noise:.2g} N: the record has no distinct peak"
            )
        )
    forces = float(force[peak]), mean, noise
    record = ShearRecord(*forces, float(x[peak]), (low, high), x, force, notes=tuple(notes))
    return record if area is None else _with_areas(record, measured_or_nan("area", area), sliding)


def _refuse_without_peak(x: FloatArray, force: FloatArray, peak: int) -> None:
    refuse_if(
        force[peak] <= 0.0,
        "is at most {.number}; forces that resist sliding are positive",
        Given("friction_force", force[peak]),
        key="friction_force",
    )
    for end, where, remedy in (
        (0, "first", "begin the record before the contact is sheared"),
        (len(x) - 1, "last", "shear farther"),
    ):
        refuse_if(
            peak == end,
            f"is largest at the {where} entry (displacement {{.number}}): the record has no peak; {remedy}",
            Given("displacement", x[peak]),
            key="friction_force",
        )


def _noise(x: FloatArray, force: FloatArray) -> float:
    """Return the standard deviation of forces about their least-squares line [N]; 0 for two points."""
    apart, rest = x - x.mean(), force - force.mean()
    square = float(apart @ apart)
    rest = rest - (float(apart @ force) / square if square > 0.0 else 0.0) * apart
    return float(np.sqrt((rest @ rest) / max(len(x) - 2, 1)))


def _with_areas(record: ShearRecord, area: FloatArray, sliding: NDArray[np.bool_]) -> ShearRecord:
    """Return the record with the areas before shear, at the peak and during sliding."""
    x, force, frames = record.displacement, record.friction_force, np.flatnonzero(np.isfinite(area))
    lengths = f"area has {len(area)} entries and displacement {len(x)}; give as many of both"
    refuse_if(len(area) != len(x), lengths)
    peak, notes = int(force.argmax()), [*record.notes]
    refuse_if(
        not frames.size or not frames[0] <= peak <= frames[-1],
        "has no frame on both sides of the peak at displacement {.number}; measure areas from before shear "
        "until sliding",
        Given("displacement", x[peak]),
        key="area",
    )
    moving = frames[sliding[frames]]
    refuse_if(not moving.size, "area has no frame in sliding_range; widen it, or leave out the areas")
    share = abs(float(force[frames[0]] / force[peak]))
    if share > UNSHEARED:
        words = f"the friction force of the first frame is {100.0 * share:.2g} % of the peak"
        notes.append(Note(f"{words}: its area may already be smaller than before shear"))
    if not np.isfinite(area[peak]):
        after = int(np.searchsorted(frames, peak))
        low, high = x[frames[after - 1 : after + 1]]
        words = f"the area at the peak, {x[peak]:.4g} mm, is interpolated between the frames at"
        notes.append(information(f"{words} {low:.4g} and {high:.4g} mm"))
    return replace(
        record,
        area=area,
        area_before=float(area[frames[0]]),
        # interpolate over the entries, which are equidistant in time; displacements may repeat
        static_area=float(np.interp(peak, frames, area[frames])),
        sliding_area=float(area[moving].mean()),
        notes=tuple(notes),
    )


def measured_or_nan(name: str, value: ArrayLike) -> FloatArray:
    """Return checked forces (k,), or positive areas (k,) summed over contacts; nan where not measured."""
    if name == "friction_force":
        return check.array_with_gaps(name, value, shape=(None,))
    entries = check.array_with_gaps(name, value, shape=(None,) * (2 if check.depth(value) > 1 else 1))
    without = "must be greater than 0; leave out points without contact"
    check.refuse_entries(name, entries, entries <= 0.0, without)
    return entries if entries.ndim == 1 else np.asarray(entries.sum(axis=1))
