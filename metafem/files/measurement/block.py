"""The sections ``[material]``, ``[friction]`` and ``[contact]`` of a specification, from a calibration."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from metafem.calibration import ContactCalibration, ShearCalibration
from metafem.files.measurement.numbers import interval, rounded
from metafem.files.specification.options import section_named

# First line, by which the file is recognised.
FIRST = "# Calibration by metafem: sections of a specification, with 68 % intervals."

# mJ/m^2 in N/mm.
ENERGY = 1e-6


def block_text(
    contact: ContactCalibration | None,
    shear: ShearCalibration | None,
    sources: Sequence[str],
    cap: str | None = None,
) -> str:
    """Return the sections as TOML; `cap` is the law of ``--contact`` in words, ``hertz`` by default."""
    lines = [FIRST, *(f"# Measured: {source}" for source in sources)]
    if contact is not None:
        lines += ["", *_material(contact), "", *_contact(contact, section_named((cap or "hertz").split()))]
    if shear is not None:
        lines += ["", *_friction(shear)]
    return "\n".join(lines) + "\n"


def is_block(content: bytes) -> bool:
    """Whether a file is a text of `block_text`."""
    return content.startswith(FIRST.encode())


def _material(found: ContactCalibration) -> list[str]:
    modulus, sd = found.composite_modulus, math.sqrt(found.root_covariance[0, 0])
    comment = interval(found.composite_modulus_interval, sd, "MPa")
    if found.adhesion_energy <= 0.0:
        modulus, sd = found.modulus_without_adhesion
        comment = f"± {rounded(sd, sd)} MPa without adhesion"
    if not found.verdict.fits:
        comment += "; the law does not fit"
    return [
        "[material]",
        f'composite_modulus = "{rounded(modulus, sd, 3)} MPa"  # {comment}',
        f"poisson_ratio = {found.material.poisson_ratio!r}",
    ]


def _contact(found: ContactCalibration, cap: Mapping[str, Any]) -> list[str]:
    low, high = (end / ENERGY for end in found.adhesion_energy_interval)
    width = 0.5 * (high - low)
    adhesion = f"{interval((low, high), width, 'mJ/m^2')}"
    if found.adhesion_energy <= 0.0 or cap["kind"] == "tabulated":
        return ["[contact]", *_keys(cap), f"# The adhesion energy is {adhesion}."]
    energy = rounded(found.adhesion_energy / ENERGY, width, 3)
    lines = ["[contact]", 'kind = "jkr"', f'adhesion_energy = "{energy} mJ/m^2"  # {adhesion}']
    if low == 0.0:
        modulus, sd = found.modulus_without_adhesion
        lines.append(
            f'# The data do not show adhesion; without it, kind = "{cap["kind"]}", composite_modulus = '
            f'"{rounded(modulus, sd, 3)} MPa".'
        )
    if cap["kind"] != "hertz":
        lines += ["", "[contact.cap]", *_keys(cap)]
    return lines


def _friction(found: ShearCalibration) -> list[str]:
    ratio, strength = (math.sqrt(found.covariance[i, i]) for i in range(2))
    fits = ["" if verdict.fits else "; the line does not fit" for verdict in _verdicts(found)]
    stress = interval(found.shear_strength_interval, strength, "MPa")
    share = interval(found.area_ratio_interval, ratio)
    return [
        "[friction]",
        f'shear_strength = "{rounded(found.shear_strength, strength, 3)} MPa"  # {stress}{fits[1]}',
        f"area_ratio = {rounded(found.area_ratio, ratio, 3)}  # {share}{fits[0]}",
    ]


def _verdicts(found: ShearCalibration) -> tuple[Any, Any]:
    return found.area_verdict, found.friction_verdict


def _keys(section: Mapping[str, Any]) -> list[str]:
    """Return the keys of a section; a text or a number in JSON is one in TOML."""
    return [f"{name} = {json.dumps(value, ensure_ascii=False)}" for name, value in section.items()]
