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
        lines += ["", *_material(contact), "", *_contact(contact, section_named((cap or "hertz").split()))]
    if shear is not None or strength is not None:
        lines += ["", *_friction(shear, strength)]
    return "\n".join(lines) + "\n"


def _material(found: ContactCalibration) -> list[str]:
    modulus, sd = found.composite_modulus, math.sqrt(found.root_covariance[0, 0])
    comment = interval(found.composite_modulus_interval, sd, "MPa")
    if not found.adhesive:
        modulus, sd = found.modulus_without_adhesion
        comment = f"± {rounded(sd, sd)} MPa without adhesion"
    if not found.verdict.fits:
        comment += "; the law does not fit"
    return [
        "[material]",
        f'composite_modulus = "{rounded(modulus, sd, 3)} MPa"  # {comment}',
        f"poisson_ratio = {found.sample.poisson_ratio!r}",
    ]


def _contact(found: ContactCalibration, cap: Mapping[str, Any]) -> list[str]:
    low, high = (end / ENERGY for end in found.adhesion_energy_interval)
    width = 0.5 * (high - low)
    adhesion = f"{interval((low, high), width, 'mJ/m^2')}"
    if not found.adhesive or cap["kind"] == "tabulated":
        return ["[contact]", *_keys(cap), f"# The adhesion energy is {adhesion}."]
    energy = rounded(found.adhesion_energy / ENERGY, width, 3)
    lines = ["[contact]", 'kind = "jkr"', f'adhesion_energy = "{energy} mJ/m^2"  # {adhesion}']
    if cap["kind"] != "hertz":
        lines += ["", "[contact.cap]", *_keys(cap)]
    return lines


def _friction(shear: ShearCalibration | None, full: StrengthFit | None) -> list[str]:
    """Return the lines of ``[friction]``; the shear strength is that of full contact, if it was measured."""
    lines = ["[friction]"]
    if full is not None:
        lines.append(_parameter("shear_strength", full, -1, full.verdict, ", of a surface in full contact"))
    elif shear is not None:
        lines.append(_parameter("shear_strength", shear, -1, shear.friction_verdict))
    if shear is not None:
        lines.append(_parameter("area_ratio", shear, 0, shear.area_verdict))
    elif full is not None:
        lines.append(f"area_ratio = {full.area_ratio!r}  # that of the part")
    return lines


def _parameter(name: str, found: Any, index: int, verdict: Verdict, remark: str = "") -> str:
    """Return the line of a parameter, with its interval; `index` is its row in the covariance."""
    unit = "MPa" if name == "shear_strength" else ""
    sd = math.sqrt(found.covariance[index, index])
    value = f"{rounded(getattr(found, name), sd, 3)} {unit}".rstrip()
    comment = interval(getattr(found, f"{name}_interval"), sd, unit) + remark
    fits = "" if verdict.fits else "; the line does not fit"
    return f"{name} = {json.dumps(value) if unit else value}  # {comment}{fits}"


def _keys(section: Mapping[str, Any]) -> list[str]:
    """Return the lines of a section's keys; JSON strings and numbers are valid in TOML."""
    return [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in section.items()]


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
