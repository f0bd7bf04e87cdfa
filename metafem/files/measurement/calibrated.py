"""Calibrations as JSON, and the covariance in it that `metafem study uncertainty` reads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from metafem._given import printable
from metafem._validate import FloatArray
from metafem.calibration import (
    ContactCalibration,
    Heterogeneity,
    ShearCalibration,
    ShearRecord,
    StrengthFit,
    Verdict,
    joint_covariance,
)
from metafem.calibration.verdict import SingleTest
from metafem.errors import InvalidInput
from metafem.files.reading import RECORD, file_label, read_bytes, read_record

# Name of the kind of file.
KIND = "metafem calibration"

# White space before the first object of JSON, and the bytes of a byte-order mark.
BLANK = b" \t\r\n\xef\xbb\xbf"

# Parameters that a calibration determines, with their units in the names of keys.
UNITS = {"radius": "mm", "composite_modulus": "MPa", "area_ratio": "1", "shear_strength": "MPa"}


# Quantities written of the record of a pull, with the units in the names of keys.
OF_RECORD = {
    "static_force": "N",
    "sliding_force": "N",
    "area_before": "mm2",
    "static_area": "mm2",
    "sliding_area": "mm2",
    "noise": "N",
}


@dataclass(frozen=True, eq=False)
class CalibratedParameters:
    """Parameters of a calibration with their values and their covariance, in mm, MPa and 1."""

    parameters: tuple[str, ...]
    value: FloatArray
    covariance: FloatArray

    @property
    def sd(self) -> FloatArray:
        """Standard deviations."""
        return np.sqrt(np.diagonal(self.covariance))


def calibration_data(
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
    sources: Sequence[str],
    records: Mapping[str, ShearRecord],
    strength: StrengthFit | None = None,
) -> dict[str, Any]:
    """Return the results for JSON, with names, values and covariance of the parameters.

    `strength` includes the parameters of the others; its shear strength is stated.
    """
    found = [each for each in (contact, shear) if each is not None] if strength is None else [strength]
    names, covariance = joint_covariance(*found)
    values: dict[str, float] = {}
    data: dict[str, Any] = {"kind": KIND, "files": list(sources)}
    if contact is not None:
        modulus, without_sd = contact.modulus_without_adhesion
        # E* of the sections of a specification: they have no adhesion if the best w is 0
        used = modulus if contact.adhesion_energy <= 0.0 else contact.composite_modulus
        values |= {"radius": contact.radius, "composite_modulus": used}
        sd = math.sqrt(contact.root_covariance[0, 0])
        data |= {
            **_stated("composite_modulus", contact, sd),
            "poisson_ratio": contact.material.poisson_ratio,
            "adhesion_energy_N_per_mm": contact.adhesion_energy,
            "adhesion_energy_interval_N_per_mm": list(contact.adhesion_energy_interval),
            "modulus_without_adhesion_MPa": modulus,
            "modulus_without_adhesion_sd_MPa": without_sd,
            "compression_verdict": _verdict(contact.verdict),
            "compression_tests": _tests(contact.tests, "composite_modulus"),
            "compression_heterogeneity": _heterogeneity(contact.heterogeneity),
            "compression_bootstrap_sd": _spread(contact.bootstrap, ("composite_modulus", "adhesion_root")),
        }
    if shear is not None:
        values |= {"area_ratio": shear.area_ratio, "shear_strength": shear.shear_strength}
        ratio_sd, strength_sd = np.sqrt(np.diagonal(shear.covariance)).tolist()
        data |= {
            **_stated("area_ratio", shear, ratio_sd),
            **_stated("shear_strength", shear, strength_sd),
            "area_ratio_verdict": _verdict(shear.area_verdict),
            "shear_strength_verdict": _verdict(shear.friction_verdict),
            "shear_tests": _tests(shear.tests, "area_ratio", "shear_strength"),
            "shear_heterogeneity": _heterogeneity(shear.heterogeneity),
            "shear_bootstrap_sd": _spread(shear.bootstrap, ("area_ratio", "shear_strength")),
        }
    if strength is not None:
        values["shear_strength"] = strength.shear_strength
        stated = _stated("shear_strength", strength, math.sqrt(strength.covariance[-1, -1]))
        data |= {f"full_contact_{key}": value for key, value in stated.items()}
        data["full_contact_verdict"] = _verdict(strength.verdict)
    if records:
        data["records"] = [
            {"file": name, **{f"{key}_{unit}": getattr(record, key) for key, unit in OF_RECORD.items()}}
            for name, record in records.items()
        ]
    return data | {
        "parameters": list(names),
        "units": [UNITS[name] for name in names],
        "values": [values[name] for name in names],
        "covariance": covariance.tolist(),
    }


def read_parameters(path: str | Path) -> CalibratedParameters:
    """Return parameters, values and covariance of a file that ``metafem calibrate`` wrote as JSON."""
    label = file_label(path)
    # a file that is not JSON is not a damaged calibration
    data = read_record(path) if read_bytes(path, RECORD).lstrip(BLANK).startswith(b"{") else None
    if not isinstance(data, dict) or data.get("kind") != KIND:
        raise InvalidInput(
            f"{label} is not a calibration; write one with metafem calibrate DATA.csv -o calibration.json"
        )
    try:
        names = tuple(str(name) for name in data["parameters"])
        value, covariance = np.array(data["values"], float), np.array(data["covariance"], float)
    except (KeyError, TypeError, ValueError):
        raise InvalidInput(f"{label} is damaged: parameters, values or covariance cannot be read") from None
    unknown = [name for name in names if name not in UNITS]
    count = len(names)
    if unknown or len(set(names)) != count or value.shape != (count,) or covariance.shape != (count, count):
        raise InvalidInput(
            f"{label} is damaged: parameters, values and covariance of {printable(str(names), 80)} do not "
            "fit together"
        )
    variance = np.diagonal(covariance)
    if not (np.isfinite(value).all() and np.isfinite(covariance).all() and (variance >= 0.0).all()):
        raise InvalidInput(f"{label} is damaged: the covariance has variances {variance.tolist()}")
    return CalibratedParameters(names, value, covariance)


def _key(name: str, what: str = "") -> str:
    """Return the key of a parameter, or of its `what`, with its unit."""
    return f"{name}{what}" + ("" if UNITS[name] == "1" else f"_{UNITS[name]}")


def _stated(name: str, found: Any, sd: float) -> dict[str, Any]:
    """Return the value of a parameter, its standard deviation and its interval."""
    interval = list(getattr(found, f"{name}_interval"))
    return {_key(name): getattr(found, name), _key(name, "_sd"): sd, _key(name, "_interval"): interval}


def _tests(tests: Sequence[SingleTest], *names: str) -> list[dict[str, Any]]:
    """Return the parameters of each test."""
    return [
        {"test": test.name, "points": test.points}
        | {
            _key(name, what): _known(numbers[i])
            for i, name in enumerate(names)
            for what, numbers in (("", test.value), ("_sd", test.sd))
        }
        for test in tests
    ]


def _known(value: float) -> float | None:
    """Return a number, None if it was not determined."""
    return None if math.isnan(value) else float(value)


def _verdict(found: Verdict) -> dict[str, Any]:
    data: dict[str, Any] = {"fits": found.fits, "freedom": found.freedom}
    for test in found.tests:
        probability = "probability" if test.name == "chi_square" else f"{test.name}_probability"
        data |= {test.name: test.statistic, probability: test.probability}
    return data


def _heterogeneity(found: Heterogeneity | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {key: getattr(found, key) for key in ("agree", "chi_square", "freedom", "probability")}


def _spread(draws: FloatArray | None, names: tuple[str, str]) -> dict[str, float] | None:
    """Return the standard deviations of a bootstrap, None of fewer than two draws with a fit."""
    if draws is None or len(draws) < 2:
        return None
    return dict(zip(names, draws.std(axis=0, ddof=1).tolist(), strict=True))
