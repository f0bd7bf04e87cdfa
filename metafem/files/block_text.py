"""Writing of a calibration as sections of a specification, and of values with their errors."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from metafem.calibration import ContactCalibration, ShearCalibration, StrengthFit, Verdict
from metafem.files.specification.options import section_named

# First line of the file.
FIRST = "# Calibration by metafem: sections of a specification, with 68 % intervals."

# mJ/m^2 in N/mm.
ENERGY = 1e-6


def block_text(
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
    sources: Sequence[str],
    cap: str | None = None,
    strength: StrengthFit | None = None,
) -> str:
    """Return the sections as TOML.

    `cap` is the contact law as the option ``--contact`` states it; default: "hertz". The shear strength is
    taken from `strength` if it is present, otherwise from `shear`.
    """
    lines = [FIRST, *(f"# Measured: {source}" for source in sources)]
    if contact is not None:
        fits = "" if contact.verdict.fits else "; the law does not fit"
        modulus, sd = contact.composite_modulus, math.sqrt(contact.root_covariance[0, 0])
        comment = interval(contact.composite_modulus_interval, sd, "MPa")
        if not contact.adhesive:
            modulus, sd = contact.modulus_without_adhesion
            comment = f"± {rounded(sd, sd)} MPa without adhesion"
        lines += ["", "[material]", _line("composite_modulus", modulus, sd, "MPa", comment + fits)]
        lines += [f"poisson_ratio = {contact.sample.poisson_ratio!r}", ""]
        lines += _contact(contact, section_named((cap or "hertz").split()))
    found: Any = strength or shear
    if found is None:
        return "\n".join(lines) + "\n"
    verdict = found.verdict if strength else found.friction_verdict
    remark = ", of a surface in full contact" if strength else ""
    lines += ["", "[friction]", _parameter("shear_strength", found, -1, verdict, "MPa", remark)]
    if shear is not None:
        lines.append(_parameter("area_ratio", shear, 0, shear.area_verdict))
    else:
        lines.append(f"area_ratio = {found.area_ratio!r}  # that of the part")
    return "\n".join(lines) + "\n"


def _contact(found: ContactCalibration, cap: Mapping[str, Any]) -> list[str]:
    low, high = (end / ENERGY for end in found.adhesion_energy_interval)
    sd = 0.5 * (high - low)
    comment = interval((low, high), sd, "mJ/m^2")
    # JSON strings and numbers are valid in TOML
    keys = [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in cap.items()]
    if not found.adhesive or cap["kind"] == "tabulated":
        return ["[contact]", *keys, f"# The adhesion energy is {comment}."]
    energy = _line("adhesion_energy", found.adhesion_energy / ENERGY, sd, "mJ/m^2", comment)
    inner = ["", "[contact.cap]", *keys] if cap["kind"] != "hertz" else []
    return ["[contact]", 'kind = "jkr"', energy, *inner]


def _parameter(name: str, found: Any, i: int, verdict: Verdict, unit: str = "", remark: str = "") -> str:
    """Return the line of a parameter, with its interval; `i` is its row in the covariance."""
    sd = math.sqrt(found.covariance[i, i])
    comment = interval(getattr(found, f"{name}_interval"), sd, unit) + remark
    fits = "" if verdict.fits else "; the line does not fit"
    return _line(name, getattr(found, name), sd, unit, comment + fits)


def _line(name: str, value: float, sd: float, unit: str, comment: str) -> str:
    text = f"{rounded(value, sd, 3)} {unit}".rstrip()
    return f"{name} = {json.dumps(text) if unit else text}  # {comment}"


def rounded(value: float, sd: float, digits: int = 2) -> str:
    """Return a value as text, with the decimals that show `digits` digits of its standard deviation.

    Examples
    --------
    >>> rounded(1.35987, 0.0193), rounded(0.37, 0.0)
    ('1.360', '0.37')
    """
    if not (sd > 0.0 and math.isfinite(sd)):
        return f"{value:.6g}"
    return f"{value:.{_places(sd, digits)}f}"


def published(value: float, sd: float, unit: str = "") -> str:
    """Return "value ± standard deviation"; the deviation has one digit, or two if its first digit is 1.

    Examples
    --------
    >>> published(1.35987, 0.0393, "MPa"), published(0.8512, 0.0121)
    ('1.36 ± 0.04 MPa', '0.851 ± 0.012')
    """
    digits = 1
    if sd > 0.0 and f"{sd:.1e}"[0] == "1":
        digits = 2
    return f"{rounded(value, sd, digits)} ± {rounded(sd, sd, digits)} {unit}".rstrip()


def interval(ends: tuple[float, float], sd: float, unit: str = "") -> str:
    """Return an interval as text, with the decimals that show two digits of the standard deviation.

    Examples
    --------
    >>> interval((1.3406, 1.3794), 0.0193, "MPa")
    '1.341 to 1.379 MPa'
    """
    low, high = (rounded(end, sd) for end in ends)
    return f"{low} to {high} {unit}".rstrip()


def _places(sd: float, digits: int) -> int:
    """Return the number of decimals that show `digits` digits of a standard deviation."""
    return max(0, digits - 1 - math.floor(math.log10(float(f"{sd:.{digits - 1}e}"))))
