"""Checks of the arrays of a measured law, their default standard deviations, and sorting by load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.errors import refuse_if

# Quantities of a measured law, and names of all its arrays, including the standard deviations.
QUANTITIES = ("load", "friction_force", "asperity_area", "area")
ARRAYS = (*QUANTITIES, *(f"{name}_sd" for name in QUANTITIES), "site")

# Number of standard deviations by which a force or an area may lie below zero. A larger deviation is not a
# measurement error: only one normal error in a million is so large.
BELOW_ZERO = 5.0

# Number of standard deviations by which a slope may lie below zero. A larger deviation contradicts every
# friction law of contacts: only one normal error in thirty thousand is so large.
FALLING = 4.0

# A load without contact has an error too: the standard deviation of a total area is at least the value for
# this fraction of the largest area.
SMALL_CONTACT = 0.01


def checked(passed: Mapping[str, Any], errors: MeasurementErrors) -> dict[str, Any]:
    """Return the known arrays of a law, sorted by load."""
    found: dict[str, Any] = {"load": check.array("load", passed["load"], shape=(None,))}
    count = len(found["load"])
    refuse_if(
        all(passed[name] is None for name in QUANTITIES[1:]),
        "a measured law needs friction_force, area or asperity_area",
    )
    if passed["friction_force"] is not None:
        found["friction_force"] = check.array("friction_force", passed["friction_force"], shape=(count,))
    if passed["asperity_area"] is not None:
        found |= _asperities(passed["asperity_area"], passed["site"], count)
    found |= _area(passed["area"], count, found)
    for name, needed in (*((f"{name}_sd", name) for name in QUANTITIES), ("site", "asperity_area")):
        refuse_if(passed[name] is not None and needed not in found, f"{name} needs {needed}")
    for name in QUANTITIES:
        if name in found:
            found[f"{name}_sd"] = _deviation(name, passed, found, errors)
    for name in ("load", "friction_force", "area"):
        if name in found:
            _refuse_negative(name, found[name], found[f"{name}_sd"])
            _refuse_falling(name, found)
    order = np.argsort(found["load"], kind="stable")
    ordered = {name: values if name == "site" else values[order] for name, values in found.items()}
    for values in ordered.values():
        values.flags.writeable = False
    return ordered


def _asperities(areas: Any, numbers: Any, count: int) -> dict[str, Any]:
    """Return the checked areas of the asperities and the numbers of the asperities."""
    filled = check.array_with_gaps("asperity_area", areas, shape=(count, None))
    check.refuse_entries("asperity_area", filled, filled < 0.0, "must be at least 0; 0 is an open contact")
    site = np.arange(filled.shape[1]) if numbers is None else np.array(numbers)
    refuse_if(
        site.shape != filled.shape[1:] or site.dtype.kind not in "iu" or (site < 0).any(),
        f"site = {shown(numbers)} must hold the number of each of the {filled.shape[1]} asperities of "
        "asperity_area in the design",
    )
    several, counts = np.unique(site, return_counts=True)
    twice = f"site holds {several[counts.argmax()]} twice; each asperity has its own site"
    refuse_if((counts > 1).any(), twice)
    return {"asperity_area": filled, "site": site.astype(np.intp)}


def _area(area: Any, count: int, found: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Return the checked total areas, or the sums over the asperities, nan where an area was not measured."""
    areas = found.get("asperity_area")
    unknown = np.zeros(count, dtype=bool) if areas is None else np.isnan(areas).any(axis=1)
    if area is not None:
        total = check.array_with_gaps("area", area, shape=(count,))
        required = "must be a number, since no area of a contact is unknown"
        check.refuse_entries("area", total, np.isnan(total) & ~unknown, required)
        return {"area": total}
    if areas is None or ("friction_force" in found and unknown.all()):
        return {}
    return {"area": areas.sum(axis=1)}


def _deviation(
    name: str, passed: Mapping[str, Any], found: Mapping[str, Any], errors: MeasurementErrors
) -> FloatArray:
    """Return the standard deviations of a quantity, as passed or computed from `errors`."""
    values, sd = found[name], passed[f"{name}_sd"]
    missing = np.isnan(values)
    if sd is not None:
        filled = np.where(missing, 1.0, sd) if missing.any() and np.shape(sd) == values.shape else sd
        # the standard deviation of an open contact may be 0
        checked = check.array(f"{name}_sd", filled, shape=values.shape, positive=name != "asperity_area")
        return np.where(missing, np.nan, checked)
    of = {"load": errors.of_load, "friction_force": errors.of_friction_force}.get(name, errors.of_area)
    if name != "area":
        return of(values)
    total, parts = of(values), values  # equal for n contacts and for one: variances add
    if passed["area"] is None:
        closed = found["asperity_area"] > 0.0
        total = np.sqrt((np.where(closed, found["asperity_area_sd"], 0.0) ** 2).sum(axis=1))
    if missing.any():  # where the total is unknown, use the sum of the known areas
        parts = np.where(missing, np.nansum(found["asperity_area"], axis=1), values)
    largest = float(parts.max())
    most = Given("area", largest)
    refuse_if(not largest > 0.0, "is {.number} at most: there is no contact", most, key="area")
    return np.where(missing, np.nan, np.maximum(total, of(np.array(SMALL_CONTACT * largest))))


def _refuse_negative(name: str, values: FloatArray, sd: FloatArray) -> None:
    i = int(np.where(np.isnan(values), np.inf, values / sd).argmin())
    refuse_if(
        values[i] < -BELOW_ZERO * sd[i],
        f"is below 0 by {-values[i] / sd[i]:.0f} standard deviations; check the sign of the force or the "
        "zero of the instrument",
        key=f"{name}[{i}]",
        value=values[i],
    )


def _refuse_falling(name: str, found: Mapping[str, FloatArray]) -> None:
    """Raise InvalidInput if the friction or the area decreases with the load."""
    known = np.flatnonzero(~np.isnan(found[name]))
    load, values, load_sd = found["load"][known], found[name][known], found["load_sd"][known]
    if not known.size or np.ptp(load) <= load_sd.max():
        return
    centred = load - load.mean()
    weight = centred / (centred**2).sum()
    slope = float(weight @ values)
    # errors of the loads also change the values, in proportion to the slope
    sd = np.sqrt((weight**2) @ (found[f"{name}_sd"][known] ** 2 + (slope * load_sd) ** 2))
    ends = [
        (Given(f"{name}[{known[i]}]", values[i]), Given("load", load[i]))
        for i in (load.argmin(), load.argmax())
    ]
    refuse_if(
        slope < -FALLING * sd,
        "{} at {.number} and {} at {.number}: it decreases with the load, which no friction law of contacts "
        "does; check the columns and their units",
        *ends[0],
        *ends[1],
    )
