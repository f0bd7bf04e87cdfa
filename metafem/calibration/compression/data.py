"""Checked loads and contact areas of compression tests."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration.compression.distance_fit import DistanceFit, adhesive_load, distance_fit
from metafem.calibration.compression.scene import AreaCurve
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.verdict import labels_of
from metafem.errors import InvalidInput, NotConverged, refuse_if

# Smallest number of points: two for the parameters and one for a residual.
FEWEST = 3

# Number of points at which a figure shows the law.
GRID = 200

# Smallest relative range of areas for which a fit is possible, and the relative rounding error of areas.
ONE_AREA, ROUNDING = 1e-6, 1e-9


@dataclass(frozen=True, eq=False)
class Data:
    """Total loads (k,) [N] and areas (k, n) [mm^2] of single contacts.

    Each area represents `contacts` contacts: all contacts of the sample if only their total was measured,
    else one.
    """

    load: FloatArray
    load_sd: FloatArray
    area: FloatArray
    area_sd: FloatArray | None
    contacts: int
    one_by_one: bool
    errors: MeasurementErrors
    test: tuple[str, ...]

    @property
    def total_contacts(self) -> int:
        """Number of contacts that share a load."""
        return int(self.contacts * self.area.shape[1])

    def sd_of(self, area: FloatArray, rows: Any = slice(None)) -> FloatArray:
        """Return the standard deviations of areas in these rows [mm^2], from `area_sd` or `errors`."""
        if self.area_sd is not None:
            return np.asarray(self.area_sd[rows])
        # the errors of different contacts are independent
        return self.errors.of_area(area) / math.sqrt(self.contacts)

    def fit(self, curve: AreaCurve, rows: Any = slice(None)) -> DistanceFit:
        """Return the fit to the rows (k,), or one fit to each set of rows (draws, k)."""
        return distance_fit(
            self.load[rows],
            self.area[rows],
            curve.load_and_slope,
            contacts=self.contacts,
            load_sd=self.load_sd[rows],
            area_sd=partial(self.sd_of, rows=rows),
            largest=curve.largest,
        )

    def law(self, curve: AreaCurve, fit: DistanceFit) -> tuple[FloatArray, FloatArray]:
        """Return loads [N] and total areas [mm^2] of a fitted law for contacts of equal area, both (m,)."""
        single = np.linspace(0.0, float(self.area.sum(axis=1).max()) / self.area.shape[1], GRID)
        each = np.repeat(single[:, None], self.area.shape[1], axis=1)
        return self.loads(curve, fit, each), self.total_contacts * single

    def loads(self, curve: AreaCurve, fit: DistanceFit, area: FloatArray) -> FloatArray:
        """Return the loads [N] of a fitted law, (m,), at areas of single contacts (m, n) [mm^2]."""
        rescaled, lowered = curve.load_and_slope(area)[0], adhesive_load(area)[0]
        return np.asarray(self.contacts * (fit.modulus * rescaled - fit.product * lowered).sum(axis=1))

    def refuse_beyond(self, curve: AreaCurve, law: Any, radius: float) -> None:
        """Raise InvalidInput if an area exceeds the largest area of the curve or of a cap of this radius."""
        largest = np.broadcast_to(curve.largest, self.area.shape)
        for i, j in np.argwhere(self.area > (1.0 + ROUNDING) * largest)[:1].tolist():
            raise InvalidInput(
                "is beyond {.number}, the last area of {.number}; leave the point out, or give a law that "
                "reaches it",
                Given("area", self.contacts * float(largest[i, j])),
                Given("contact", shown(law)),
                **self._entry(i, j),
            )
        i, j = np.unravel_index(int(self.area.argmax()), self.area.shape)
        widest = math.sqrt(float(self.area[i, j]) / math.pi) / radius
        refuse_if(
            widest > 1.0,
            f"is that of a contact radius of {widest:.4g} R, which no cap has; check the radius, "
            "{.number}, the unit of the areas, and the number of contacts that share a load, "
            f"{self.total_contacts}",
            Given("radius", radius),
            **self._entry(int(i), int(j)),
        )

    def checked_fit(self, curve: AreaCurve) -> DistanceFit:
        """Return the fit to all points, or raise InvalidInput if the load falls as the area grows."""
        fit = self.fit(curve)
        if not fit.converged:
            uncertain = self.sd_of(self.area) / np.where(self.area > 0.0, self.area, np.inf)
            i, j = np.unravel_index(int(uncertain.argmax()), uncertain.shape)
            raise NotConverged(
                "the fit of E* and the adhesion energy does not converge; the most uncertain area is {}, "
                f"with an error of {percent(float(uncertain.max()))}; leave out areas that are not much "
                "larger than their errors, or check their unit",
                fit,
                Given(*self._entry(int(i), int(j)).values()),
            )
        order = np.argsort(self.area.sum(axis=1), kind="stable")
        refuse_if(
            not fit.modulus > 0.0,
            "the load does not grow with the contact area: {} at the smallest area and {} at the largest, "
            f"and the fitted E* is {float(fit.modulus):.3g} MPa; check the columns and their order",
            *(Given(f"load[{i}]", self.load[i]) for i in order[[0, -1]].tolist()),
        )
        return fit

    def _entry(self, i: int, j: int) -> dict[str, Any]:
        """Return the key and the value of an area for an error."""
        if self.one_by_one:
            return {"key": f"area[{i}, {j}]", "value": self.area[i, j]}
        return {"key": f"area[{i}]", "value": self.contacts * self.area[i, j]}


def checked_data(
    load: Any, area: Any, number: int, errors: MeasurementErrors, area_sd: Any, test: Any
) -> Data:
    """Return the checked data; an error names the invalid row."""
    check.instance("errors", errors, MeasurementErrors, "a metafem.calibration.MeasurementErrors")
    loads = check.array("load", load, shape=(None,))
    count, one_by_one = len(loads), check.depth(area) == 2
    refuse_if(
        count < FEWEST,
        f"load has {count} points; E* and the adhesion energy need at least {FEWEST}, at different areas",
    )
    shape = (count, number) if one_by_one else (count,)
    areas = check.array("area", area, shape=shape)
    check.refuse_entries("area", areas, areas < 0.0, "must not be negative")
    total = areas.sum(axis=1) if one_by_one else areas
    check.refuse_entries("area", total, total == 0.0, "is no contact; leave the row out")
    alike = "all areas are {.number}: E* and the adhesion energy need points at different areas"
    refuse_if(np.ptp(total) <= ONE_AREA * total.max(), alike, Given("area", total.max()))
    sd = None
    if area_sd is not None:
        sd = check.array("area_sd", area_sd, shape=shape)
        wrong = (sd < 0.0) | ((sd == 0.0) & (areas > 0.0))
        check.refuse_entries("area_sd", sd, wrong, "must be greater than 0")
    of_each = 1 if one_by_one else number
    areas = areas.reshape(count, -1) / of_each
    sd = None if sd is None else sd.reshape(count, -1) / of_each
    labels = labels_of(test, count)
    return Data(loads, errors.of_load(loads), areas, sd, of_each, one_by_one, errors, labels)
