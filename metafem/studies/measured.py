"""Measured laws: the datasets of a comparison with a design and of an explanation, and their summaries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent, three_digits
from metafem.calibration import Comparison, Explanation
from metafem.calibration.explanation import row
from metafem.calibration.statistics import REJECTED, Verdict
from metafem.models import Model
from metafem.studies.dataset import Summary, Variables, dataset, texts

if TYPE_CHECKING:
    import xarray as xr

# Attributes of a measured law and of its comparison that are stored for each point.
OF_LAW = [f"{name}{sd}" for name in ("load", "rescaled_load", "rescaled_friction") for sd in ("", "_sd")]
OF_POINT = ("predicted", "deviation", "deviation_sd")


def measured(comparison: Comparison, model: Model) -> xr.Dataset:
    """Return the dataset of the comparison of a measured law with a design.

    Parameters
    ----------
    comparison : metafem.calibration.Comparison
    model : Model
        Model of the design's law.

    Returns
    -------
    xarray.Dataset
        Over ``point``: ``load`` [N], ``rescaled_load``, ``rescaled_friction``, ``predicted`` and
        ``deviation`` [mm^2], which have ``..._sd`` but for ``predicted``. Single numbers are ``stress``
        [MPa], the friction force over the rescaled one, 0 for a law of areas, ``chi_square``, ``freedom``
        and ``fits``, 1 if the law agrees with the design.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.LinearLaw(6.87), template)
    >>> law = mf.calibration.MeasuredLaw([0.1, 0.3], area=[0.6, 1.8], material=template.material)
    >>> measured(mf.calibration.compare(law, design), design.law.model).deviation.values.round(3)
    array([-0.057,  0.054])
    """
    law, verdict = comparison.measured, comparison.verdict
    variables: Variables = {name: (("point",), getattr(law, name)) for name in OF_LAW}
    variables |= {name: (("point",), getattr(comparison, name)) for name in OF_POINT}
    single = {"chi_square": verdict.chi_square, "freedom": verdict.freedom, "fits": int(verdict.fits)}
    variables |= {name: ((), value) for name, value in {"stress": law.stress_of_forces, **single}.items()}
    origin = {"model": repr(model), "parameters": " ".join(comparison.parameters)}
    return dataset("measured", variables, {}, comparison.notes, **origin)


def explained(found: Explanation) -> xr.Dataset:
    """Return the dataset of the errors that explain a measured law.

    Parameters
    ----------
    found : metafem.calibration.Explanation

    Returns
    -------
    xarray.Dataset
        Over ``cause``: ``expected``, ``mean`` and ``sd`` [rad or relative]. Single numbers are
        ``misfit_design`` and ``misfit``, chi-square without and with these errors, ``values``, the number of
        measured values, and ``fits``, 1 if the errors explain them.

    Examples
    --------
    >>> import metafem as mf
    >>> from metafem.calibration import MeasuredLaw, explain
    >>> material = mf.Material(1.36)
    >>> design = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=material)
    >>> measured = MeasuredLaw([0.1, 0.2], area=[0.42, 0.7], material=material)
    >>> explained(explain(measured, design, model=mf.Independent())).cause.values.tolist()
    ['angle_x', 'angle_y', 'height_scale', 'composite_modulus']
    """
    causes, verdict = np.array(list(found.mean), dtype=str), found.verdict
    variables: Variables = {
        name: (("cause",), np.array(list(getattr(found, name).values())))
        for name in ("expected", "mean", "sd")
    }
    variables |= {
        "misfit_design": ((), found.misfit_design),
        "misfit": ((), verdict.chi_square),
        "values": ((), verdict.freedom),
        "fits": ((), int(verdict.fits)),
    }
    return dataset("explained", variables, {"cause": causes}, [], model=repr(found.model))


def measured_summary(study: xr.Dataset) -> Summary:
    """Return the table of the deviations of all points, and a sentence on the law."""
    # the numbers have the units of the table: friction forces, or areas
    stress = float(study["stress"])
    factor, what = (stress, " F [N]") if stress > 0.0 else (1.0, " area [mm²]")
    names = ("rescaled_friction", "rescaled_friction_sd", "predicted", "deviation")
    value, sd, design, deviation = (factor * study[name].values for name in names)
    columns: dict[str, Any] = {"P [N]": texts(".4g", study["load"].values)}
    columns |= {f"measured{what}": texts(".4g", value), "±": texts(".2g", sd)}
    columns |= {f"design{what}": texts(".4g", design), "deviation": _relative(value, design)}
    columns |= {"in s.d.": texts("+.1f", deviation / (factor * study["deviation_sd"].values))}
    ratio = (deviation / np.where(design > 0.0, design, np.nan))[design > 0.0]
    rms = percent(float(np.sqrt((ratio**2).mean()))) if ratio.size else "unknown"
    agrees, rejected = ("agrees", "not rejected") if int(study["fits"]) else ("does not agree", "rejected")
    answer = (
        f"The measured law {agrees} with the design within its error bars ({rejected} at "
        f"{percent(REJECTED)}): rms deviation {rms}, "
        f"{Verdict(float(study['chi_square']), int(study['freedom']))}."
    )
    return Summary.of(study, "Measured law and design", columns, answer)


def _relative(value: FloatArray, reference: FloatArray) -> list[str]:
    """Return relative differences as texts; "-" where the reference is not positive."""
    pairs = zip(value.tolist(), reference.tolist(), strict=True)
    return [percent(one / other - 1.0, "+.1f") if other > 0.0 else "-" for one, other in pairs]


def explained_summary(study: xr.Dataset) -> Summary:
    """Return the table of the errors that explain a law, and a sentence on the misfit."""
    values = (study[name].values.tolist() for name in ("cause", "mean", "sd", "expected"))
    rows = zip(*(row(*each) for each in zip(*values, strict=True)), strict=True)
    columns = dict(zip(("cause", "found (68 %)", "expected"), rows, strict=True))
    misfit, count = float(study["misfit"]), float(study["values"])
    explains = "agrees" if int(study["fits"]) else "does not agree"
    words = f"with the {count:.0f} measured values: chi² = {three_digits(misfit)}."
    answer = f"A part with these errors {explains} {words}"
    return Summary.of(study, "What explains the measured law", columns, answer)
