"""The arrays of a measured law: checked, completed by their standard deviations and sorted by load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.errors import InvalidInput

# The quantities of a measured law, and the arrays with their standard deviations.
QUANTITIES = ("load", "friction_force", "asperity_area", "area")
ARRAYS = (*QUANTITIES, *(f"{name}_sd" for name in QUANTITIES), "site")

# A force or an area below zero by more than this number of standard deviations is not an error of
# measurement: one normal error in a million is so large.
BELOW_ZERO = 5.0

# A slope below zero by more than this number of standard deviations contradicts every friction law of
# contacts: one normal error in thirty thousand is so large.
FALLING = 4.0

# Area that determines the error at a load without contact, over the largest area.
SMALL_CONTACT = 0.01


def checked(passed: Mapping[str, Any], errors: MeasurementErrors) -> dict[str, Any]:
    """Return the arrays of a law that are known, in the order of load."""
    found: dict[str, Any] = {"load": check.array("load", passed["load"], shape=(None,))}
    count = len(found["load"])
    if passed["friction_force"] is not None:
        found["friction_force"] = check.array("friction_force", passed["friction_force"], shape=(count,))
    asperities = _asperities(passed, count)
    found |= _area(passed["area"], count, asperities.get("asperity_area"), "friction_force" in found)
    found |= asperities
    if "friction_force" not in found and "area" not in found:
        raise InvalidInput("a measured law needs friction_force, area or asperity_area")
    for name in QUANTITIES:
        if name in found:
            found[f"{name}_sd"] = _deviation(name, passed, found, errors)
        elif passed[f"{name}_sd"] is not None:
            raise InvalidInput(f"{name}_sd needs {name}")
    for name in ("load", "friction_force", "area"):
        if name in found:
            _refuse_negative(name, found[name], found[f"{name}_sd"])
    _refuse_falling(found)
    order = np.argsort(found["load"], kind="stable")
    ordered = {name: values if name == "site" else values[order] for name, values in found.items()}
    for values in ordered.values():
        values.flags.writeable = False
    return ordered


def _asperities(passed: Mapping[str, Any], count: int) -> dict[str, Any]:
    """Return the checked areas of the asperities and their numbers."""
    if passed["asperity_area"] is None:
        if passed["site"] is not None:
            raise InvalidInput("site needs asperity_area")
        return {}
    filled = check.array_with_gaps("asperity_area", passed["asperity_area"], shape=(count, None))
    check.refuse_entries("asperity_area", filled, filled < 0.0, "must be at least 0; 0 is an open contact")
    site = np.arange(filled.shape[1]) if passed["site"] is None else np.array(passed["site"])
    if site.shape != filled.shape[1:] or site.dtype.kind not in "iu" or (site < 0).any():
        raise InvalidInput(
            f"site = {shown(passed['site'])} must hold the number of each of the {filled.shape[1]} "
            "asperities of asperity_area in the design"
        )
    numbers, counts = np.unique(site, return_counts=True)
    if (counts > 1).any():
        raise InvalidInput(f"site holds {numbers[counts.argmax()]} twice; each asperity has its own site")
    return {"asperity_area": filled, "site": site.astype(np.intp)}


def _area(area: Any, count: int, areas: FloatArray | None, by_force: bool) -> dict[str, FloatArray]:
    """Return the checked total areas, or the sums over the asperities: nan where one was not measured."""
    if area is None:
        if areas is None or (by_force and np.isnan(areas).any(axis=1).all()):
            return {}
        return {"area": areas.sum(axis=1)}
    found = check.array_with_gaps("area", area, shape=(count,))
    unknown = False if areas is None else np.isnan(areas).any(axis=1)
    required = "must be a number, since no area of a contact is unknown"
    check.refuse_entries("area", found, np.isnan(found) & ~np.asarray(unknown), required)
    return {"area": found}


def _deviation(
    name: str, passed: Mapping[str, Any], found: Mapping[str, Any], errors: MeasurementErrors
) -> FloatArray:
    """Return the standard deviation of a quantity, as passed or from the errors."""
    values, sd = found[name], passed[f"{name}_sd"]
    missing = np.isnan(values)
    if sd is not None:
        filled = np.where(missing, 1.0, sd) if missing.any() and np.shape(sd) == values.shape else sd
        # the standard deviation of an open contact may be 0
        checked = check.array(f"{name}_sd", filled, shape=values.shape, positive=name != "asperity_area")
        return np.where(missing, np.nan, checked)
    if name == "load":
        return errors.of_load(values)
    if name == "friction_force":
        return errors.of_friction_force(values)
    if name == "asperity_area":
        return errors.of_area(values)
    if passed["area"] is None:
        closed = found["asperity_area"] > 0.0
        total: FloatArray = np.sqrt((np.where(closed, found["asperity_area_sd"], 0.0) ** 2).sum(axis=1))
    else:
        total = errors.of_area(values)  # the same for n contacts together as for one: the squares add up
    # known contacts count at loads with an unknown total
    parts = np.nansum(found["asperity_area"], axis=1) if missing.any() else values
    largest = float(np.where(missing, parts, values).max())
    if not largest > 0.0:
        raise InvalidInput("is {.number} at most: there is no contact", Given("area", largest), key="area")
    sd = np.maximum(total, errors.of_area(np.array(SMALL_CONTACT * largest)))
    return np.where(missing, np.nan, sd)


def _refuse_negative(name: str, values: FloatArray, sd: FloatArray) -> None:
    i = int(np.where(np.isnan(values), np.inf, values / sd).argmin())
    if values[i] < -BELOW_ZERO * sd[i]:
        raise InvalidInput(
            f"is below 0 by {-values[i] / sd[i]:.0f} standard deviations; check the sign of the force or the "
            "zero of the instrument",
            key=f"{name}[{i}]",
            value=values[i],
        )


def _refuse_falling(found: Mapping[str, FloatArray]) -> None:
    """Refuse points whose friction or area decreases with the load."""
    for name in ("friction_force", "area"):
        if name not in found:
            continue
        known = np.flatnonzero(~np.isnan(found[name]))
        load, values, load_sd = found["load"][known], found[name][known], found["load_sd"][known]
        if not known.size or np.ptp(load) <= load_sd.max():
            continue
        centred = load - load.mean()
        weight = centred / (centred**2).sum()
        slope = float(weight @ values)
        # the errors of the loads add to those of the values in proportion to the slope
        sd = np.sqrt((weight**2) @ (found[f"{name}_sd"][known] ** 2 + (slope * load_sd) ** 2))
        if slope < -FALLING * sd:
            first, last = int(load.argmin()), int(load.argmax())
            ends = [
                Given(key, value)
                for i in (first, last)
                for key, value in ((f"{name}[{known[i]}]", values[i]), ("load", load[i]))
            ]
            raise InvalidInput(
                "{} at {.number} and {} at {.number}: it decreases with the load, which no friction law of "
                "contacts does; check the columns and their units",
                *ends,
            )
