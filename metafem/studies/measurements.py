"""Datasets of a result folder on measured laws: comparisons with a design, and explanations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from metafem.calibration import Comparison, Explanation
from metafem.errors import refuse_if
from metafem.models import Model
from metafem.studies.sampling.dataset import Variables, dataset

if TYPE_CHECKING:
    import xarray as xr

# Attributes of a measured law that are stored for each point.
OF_LAW = [f"{name}{sd}" for name in ("load", "rescaled_load", "rescaled_friction") for sd in ("", "_sd")]


def measured(comparisons: Sequence[Comparison], model: Model) -> xr.Dataset:
    """Return the dataset of the comparisons of one or more measured laws with one design.

    Parameters
    ----------
    comparisons : sequence of metafem.calibration.Comparison
        Comparisons of laws with different labels, such as "static" and "sliding".
    model : Model
        Model of the design's law.

    Returns
    -------
    xarray.Dataset
        Over ``point``, the points of all laws: the label ``of_law``, ``load`` [N], ``rescaled_load``,
        ``rescaled_friction``, ``predicted`` and ``deviation`` [mm^2], which have ``..._sd`` but for
        ``predicted``, and ``stress`` [MPa], the friction force over the rescaled one, 0 for a law of areas.
        Over ``feature``: ``of_law_feature``, ``value``, ``value_sd``, ``design`` and ``target``. Over
        ``law``: ``chi_square``, ``freedom``, ``probability``, ``fits`` (1 if the law agrees with the design)
        and ``verdict``.

    Raises
    ------
    InvalidInput
        If two laws have the same label, or if there is no law.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.LinearLaw(6.87), template)
    >>> law = mf.calibration.MeasuredLaw([0.1, 0.3], area=[0.6, 1.8], material=template.material)
    >>> measured([mf.calibration.compare(law, design)], design.law.model).deviation.values.round(3)
    array([-0.057,  0.054])
    """
    labels = [comparison.measured.label for comparison in comparisons]
    words = f"the labels of the measured laws, {labels!r:.80}, must be different"
    refuse_if(not labels or len(set(labels)) < len(labels), words)

    points = [
        {name: getattr(each.measured, name)[each.point] for name in OF_LAW}
        | {name: getattr(each, name) for name in ("predicted", "deviation", "deviation_sd")}
        for each in comparisons
    ]
    variables: Variables = {
        name: (("point",), np.concatenate([each[name] for each in points])) for name in points[0]
    }
    counts = [len(each.point) for each in comparisons]
    stress = [each.measured.stress_of_forces for each in comparisons]
    variables["stress"] = ("point",), np.repeat(stress, counts)
    variables["of_law"] = ("point",), np.repeat(labels, counts)
    features = [(each.measured.label, feature) for each in comparisons for feature in each.features]
    variables["of_law_feature"] = ("feature",), np.array([label for label, _ in features], dtype=str)
    for name, attribute in {
        "value": "value",
        "value_sd": "sd",
        "design": "predicted",
        "target": "target",
    }.items():
        column = [getattr(feature, attribute) for _, feature in features]
        variables[name] = ("feature",), np.array(column, dtype=float)
    verdicts = [each.verdict for each in comparisons]
    for name in ("chi_square", "freedom", "probability"):
        variables[name] = ("law",), [getattr(verdict, name) for verdict in verdicts]
    variables["fits"] = ("law",), [int(verdict.fits) for verdict in verdicts]
    variables["verdict"] = ("law",), [str(verdict) for verdict in verdicts]
    several = len(comparisons) > 1
    notes = [
        replace(note, text=f"{each.measured.label}: {note.text}") if several else note
        for each in comparisons
        for note in each.notes
    ]
    names = np.array([feature.name for _, feature in features], dtype=str)
    coordinates = {"feature": names, "law": np.array(labels)}
    parameters = dict.fromkeys(name for each in comparisons for name in each.parameters)
    study = dataset("measured", variables, coordinates, model=model, notes=notes)
    return study.assign_attrs(parameters=" ".join(parameters))


def explained(found: Explanation) -> xr.Dataset:
    """Return the dataset of the errors that explain a measured law.

    Parameters
    ----------
    found : metafem.calibration.Explanation

    Returns
    -------
    xarray.Dataset
        Over ``cause``: ``expected``, ``mean`` and ``sd`` [rad or relative], and ``covariance`` over ``cause``
        and ``other_cause``. Single numbers are ``misfit_design`` and ``misfit``, chi-square without and with
        these errors, ``values``, the number of measured values, and ``fits``, 1 if the errors explain them.

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
    causes = np.array(list(found.mean), dtype=str)
    variables: Variables = {
        name: (("cause",), np.array(list(getattr(found, name).values())))
        for name in ("expected", "mean", "sd")
    }
    variables["covariance"] = ("cause", "other_cause"), found.covariance
    verdict = found.verdict
    single = {
        "misfit_design": found.misfit_design,
        "misfit": verdict.chi_square,
        "values": verdict.freedom,
        "fits": int(verdict.fits),
    }
    variables |= {name: ((), value) for name, value in single.items()}
    coordinates = {"cause": causes, "other_cause": causes}
    return dataset("explained", variables, coordinates, model=found.model, notes=())
