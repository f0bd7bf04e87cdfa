"""Joint covariance of the parameters of several calibrations, for `metafem.studies.uncertainty`."""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag

from metafem._given import shown
from metafem._validate import FloatArray
from metafem.calibration.compression.result import ContactCalibration
from metafem.calibration.sheared.full_contact import StrengthFit
from metafem.calibration.sheared.lines import ShearCalibration
from metafem.errors import refuse_if


def joint_covariance(
    *calibrations: ContactCalibration | ShearCalibration | StrengthFit,
) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of all parameters and their joint covariance.

    Calibrations from different measurements are independent, so the matrix is block diagonal.

    Parameters
    ----------
    *calibrations : ContactCalibration, ShearCalibration or StrengthFit
        Calibrations without a parameter in common.

    Returns
    -------
    names : tuple of str
    covariance : ndarray, (p, p)
        Covariance matrix; lengths in mm, stresses in MPa, as `metafem.studies.uncertainty` expects.

    Raises
    ------
    InvalidInput
        If two calibrations have the same parameter, or an argument is not a calibration.

    Examples
    --------
    >>> from metafem.calibration import fit_compression, shear
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> area = np.pi * a**2
    >>> pressed = fit_compression(1.36 * 4 / 3 * a**3 / 0.526, area, 0.526)
    >>> names, covariance = joint_covariance(pressed, shear(area, 0.85 * area, 0.3 * area))
    >>> names, np.sqrt(np.diag(covariance)).round(3)
    (('composite_modulus', 'area_ratio', 'shear_strength'), array([0.06 , 0.003, 0.002]))
    """
    names: list[str] = []
    blocks = []
    for calibration in calibrations:
        refuse_if(
            isinstance(calibration, type) or not hasattr(calibration, "parameter_covariance"),
            f"{shown(calibration)} must be a result of metafem.calibration.fit_compression or "
            "metafem.calibration.shear",
        )
        for name in calibration.parameters:
            twice = f"{name} is a parameter of two calibrations; pool their tests in one calibration"
            refuse_if(name in names, twice)
        names += calibration.parameters
        blocks.append(calibration.parameter_covariance)
    return tuple(names), np.asarray(block_diag(*blocks)) if blocks else np.zeros((0, 0))
