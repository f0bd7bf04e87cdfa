"""Writing of calibrations as JSON, and reading of their parameters and covariance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import (
    ContactCalibration,
    ShearCalibration,
    StrengthFit,
    Verdict,
    joint_covariance,
)
from metafem.errors import InvalidInput, refuse_if
from metafem.files.disk import RECORD, file_label, read_bytes, read_record

# Value of the key "kind" in the file of a calibration.
KIND = "metafem calibration"

# Bytes that may precede the first brace of a JSON file: white space and a byte-order mark.
BLANK = b" \t\r\n\xef\xbb\xbf"

# Parameters that a calibration can determine, with the units that the names of keys contain.
UNITS = {"radius": "mm", "composite_modulus": "MPa", "area_ratio": "1", "shear_strength": "MPa"}


@dataclass(frozen=True, eq=False)
class CalibratedParameters:
    """Names of a calibration's parameters, with their values (n,) and covariance (n, n), in mm, MPa and 1."""

    parameters: tuple[str, ...]
    value: FloatArray
    covariance: FloatArray

    @property
    def sd(self) -> FloatArray:
        """Standard deviations of the parameters, (n,)."""
        return np.sqrt(np.diagonal(self.covariance))


def calibration_data(
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
    sources: Sequence[str],
    strength: StrengthFit | None = None,
) -> dict[str, Any]:
    """Return the results for JSON, with names, values and covariance of the parameters.

    If `strength` is present, its covariance is used, which includes the parameters of `contact` and `shear`,
    and the shear strength is that of `strength`.
    """
    found = [each for each in (contact, shear) if each is not None] if strength is None else [strength]
    names, covariance = joint_covariance(*found)
    values: dict[str, float] = {}
    data: dict[str, Any] = {"kind": KIND, "files": list(sources)}
    if contact is not None:
        modulus, without_sd = contact.modulus_without_adhesion
        # the same E* as in the written sections, which have no adhesion if the data do not show it
        values |= {"radius": contact.radius, "composite_modulus": contact.material.composite_modulus}
        sd = math.sqrt(contact.root_covariance[0, 0])
        data |= {
            **_stated("composite_modulus", contact, sd),
            "poisson_ratio": contact.sample.poisson_ratio,
            "adhesion_energy_N_per_mm": contact.adhesion_energy,
            "adhesion_energy_interval_N_per_mm": list(contact.adhesion_energy_interval),
            "modulus_without_adhesion_MPa": modulus,
            "modulus_without_adhesion_sd_MPa": without_sd,
            "compression_verdict": _verdict(contact.verdict),
            **_tests("compression", contact, ("composite_modulus",)),
        }
    if shear is not None:
        values |= {"area_ratio": shear.area_ratio, "shear_strength": shear.shear_strength}
        ratio_sd, strength_sd = np.sqrt(np.diagonal(shear.covariance)).tolist()
        data |= {
            **_stated("area_ratio", shear, ratio_sd),
            **_stated("shear_strength", shear, strength_sd),
            "area_ratio_verdict": _verdict(shear.area_verdict),
            "shear_strength_verdict": _verdict(shear.friction_verdict),
            **_tests("shear", shear, ("area_ratio", "shear_strength")),
        }
    if strength is not None:
        values["shear_strength"] = strength.shear_strength
        stated = _stated("shear_strength", strength, math.sqrt(strength.covariance[-1, -1]))
        data |= {f"full_contact_{key}": value for key, value in stated.items()}
        data["full_contact_verdict"] = _verdict(strength.verdict)
    return data | {
        "parameters": list(names),
        "units": [UNITS[name] for name in names],
        "values": [values[name] for name in names],
        "covariance": covariance.tolist(),
    }


def read_parameters(path: str | Path) -> CalibratedParameters:
    """Return the parameters in a JSON file of ``metafem calibrate``, with their values and covariance."""
    label = file_label(path)
    # the error for a file other than JSON should not call it a damaged calibration
    data = read_record(path) if read_bytes(path, RECORD).lstrip(BLANK).startswith(b"{") else None
    if not isinstance(data, dict) or data.get("kind") != KIND:
        raise InvalidInput(
            f"{label} is not a calibration; write one with metafem calibrate DATA.csv -o calibration.json"
        )
    try:
        names = tuple(map(str, data["parameters"]))
        value, covariance = np.array(data["values"], float), np.array(data["covariance"], float)
    except (KeyError, TypeError, ValueError):
        names, value, covariance = (), np.empty(0), np.empty((0, 0))
    fits: Any = names and set(names) <= UNITS.keys() and value.shape == (len(set(names)),) == (len(names),)
    fits = fits and covariance.shape == 2 * value.shape and (np.diagonal(covariance) >= 0.0).all()
    fits = fits and np.isfinite(value).all() and np.isfinite(covariance).all()
    refuse_if(not fits, f"{label} is damaged: parameters, values and covariance do not fit together")
    return CalibratedParameters(names, value, covariance)


def _key(name: str, what: str = "") -> str:
    """Return the JSON key of a parameter, with its unit; `what` is a suffix such as "_sd"."""
    return f"{name}{what}" + ("" if UNITS[name] == "1" else f"_{UNITS[name]}")


def _stated(name: str, found: Any, sd: float) -> dict[str, Any]:
    """Return the value, standard deviation and interval of a parameter, by their JSON keys."""
    interval = list(getattr(found, f"{name}_interval"))
    return {_key(name): getattr(found, name), _key(name, "_sd"): sd, _key(name, "_interval"): interval}


def _tests(kind: str, found: Any, names: Sequence[str]) -> dict[str, Any]:
    """Return the parameters of each test, and the agreement of the tests."""
    tests = [
        {"test": test.name, "points": test.points}
        | {
            _key(name, what): None if math.isnan(numbers[i]) else float(numbers[i])
            for i, name in enumerate(names)
            for what, numbers in (("", test.value), ("_sd", test.sd))
        }
        for test in found.tests
    ]
    alike = found.heterogeneity
    return {f"{kind}_tests": tests, f"{kind}_heterogeneity": alike and _verdict(alike)}


def _verdict(found: Verdict) -> dict[str, Any]:
    names = ("fits", "chi_square", "freedom", "probability", "birge_ratio")
    return {name: getattr(found, name) for name in names}
