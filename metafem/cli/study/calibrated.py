"""Errors of the inputs of a study from a calibration and from options."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.progress import message

if TYPE_CHECKING:
    from metafem.surface import Surface

# Difference of a design value from the calibrated one, in standard deviations, above which both are printed.
APART = 2.0


def with_calibration(
    path: Path, deviations: Mapping[str, float], surface: Surface
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names and the covariance of the inputs of a calibration and of ``--sd``."""
    found = mf.files.read_parameters(path)
    twice = [name for name in found.parameters if name in deviations]
    if twice:
        raise InvalidInput(f"--sd {twice[0]} and --calibration both give the error of {twice[0]}; keep one")
    designed = {
        "radius": float(surface.radius.mean()),
        "composite_modulus": surface.material.composite_modulus,
    }
    if surface.friction is not None:
        designed["area_ratio"] = surface.friction.area_ratio
        designed["shear_strength"] = surface.friction.shear_strength
    used = [i for i, name in enumerate(found.parameters) if name in designed]
    for i in used:
        name, sd, value = found.parameters[i], float(found.sd[i]), float(found.value[i])
        if abs(value - designed[name]) > APART * sd:
            message(
                f"{name} of the design is {designed[name]:.4g}, and that of the calibration {value:.4g} ± "
                f"{sd:.2g}; the study has the value of the design with the error of the calibration"
            )
    names = (*(found.parameters[i] for i in used), *deviations)
    covariance = np.diag([*found.sd[used], *deviations.values()]) ** 2
    covariance[: len(used), : len(used)] = found.covariance[np.ix_(used, used)]
    return names, covariance
