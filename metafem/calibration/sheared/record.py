"""Records of shear tests: values at the peak of the friction force, and means during sliding."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray
from metafem.errors import refuse_if

# Range of distances after the peak over which the paper averages the sliding friction (page 313) [mm].
SLIDING = (0.1, 0.2)

# Rounding error of a difference between decimal displacements, relative to the last displacement.
ROUNDING = 1e-12


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
    x, force, peak = _record(displacement, friction_force)
    if values is None:
        return float(force[peak])
    found = check.array_with_gaps("values", values, shape=(len(x),))
    frames = np.flatnonzero(np.isfinite(found))
    no_frame = "has no frame on both sides of the peak at displacement {.number}"
    beside = frames.size > 0 and frames[0] <= peak <= frames[-1]
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
    x, force, peak = _record(displacement, friction_force)
    found = force if values is None else check.array_with_gaps("values", values, shape=(len(x),))
    after, rounding = x - x[peak], ROUNDING * x[-1]
    low, high = SLIDING
    last, top, far = (Given("displacement", end) for end in (after[-1], x[peak], high))
    early = "the record ends {.number} after the peak at displacement {.number}"
    refuse_if(after[-1] < high - rounding, f"{early}; sliding friction needs {{.number}}", last, top, far)
    sliding = (after >= low - rounding) & (after <= high + rounding) & np.isfinite(found)
    few = "the record has no value between {.number} and {.number} after the peak"
    refuse_if(not sliding.any(), few, *(Given("displacement", end) for end in SLIDING))
    return float(found[sliding].mean())


def _record(displacement: ArrayLike, friction_force: ArrayLike) -> tuple[FloatArray, FloatArray, int]:
    """Return the checked displacements and forces, and the index of the largest force."""
    x = check.array("displacement", displacement, shape=(None,))
    force = check.array("friction_force", friction_force, shape=(len(x),))
    back = np.diff(x, prepend=x[0]) < 0.0
    one_way = "is less than the one before; give one pull in one direction"
    check.refuse_entries("displacement", x, back, one_way)
    peak = int(force.argmax())
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
    return x, force, peak


def measured_or_nan(name: str, value: ArrayLike) -> FloatArray:
    """Return checked forces (k,), or positive areas (k,) summed over contacts; nan where not measured."""
    if name == "friction_force":
        return check.array_with_gaps(name, value, shape=(None,))
    entries = check.array_with_gaps(name, value, shape=(None,) * (2 if check.depth(value) > 1 else 1))
    without = "must be greater than 0; leave out points without contact"
    check.refuse_entries(name, entries, entries <= 0.0, without)
    return entries if entries.ndim == 1 else np.asarray(entries.sum(axis=1))
