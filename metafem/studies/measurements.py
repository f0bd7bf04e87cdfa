"""Comparisons of measured laws with a design and their explanation, as datasets of a result folder."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from metafem.calibration import Comparison, Explanation
from metafem.errors import InvalidInput
from metafem.models import Model
from metafem.studies.sampling.dataset import Variables, dataset
from metafem.studies.sampling.store import inputs_hash

if TYPE_CHECKING:
    import xarray as xr

    from metafem._validate import FloatArray


def measured(comparisons: Sequence[Comparison], model: Model) -> xr.Dataset:
    """Return comparisons of measured laws with one design, side by side.

    Parameters
    ----------
    comparisons : sequence of metafem.calibration.Comparison
        With different labels, such as "static" and "sliding".
    model : Model
        Model of the design's law.

    Returns
    -------
    xarray.Dataset
        Over ``point``, all points of all laws: ``of_law``, the label; ``load`` [N]; ``rescaled_load``,
        ``rescaled_friction``, ``predicted`` and ``deviation`` [mm^2], with ``..._sd``. Over ``feature``:
        ``of_law_feature``, ``value``, ``value_sd``, ``low``, ``high``, ``design``, ``target``, and ``unit``.
        Over ``law``: ``chi_square``, ``freedom``, ``probability``, ``runs``, ``runs_probability`` and
        ``verdict``.

    Raises
    ------
    InvalidInput
        If two laws have one label, or there is none.

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
    if not labels or len(set(labels)) < len(labels):
        raise InvalidInput(f"the labels of the measured laws, {labels!r:.80}, must be different")
    over_points: dict[str, list[FloatArray]] = {}
    for each in comparisons:
        law, point = each.measured, each.point
        arrays = {
            "load": law.load[point],
            "load_sd": law.load_sd[point],
            "rescaled_load": law.rescaled_load[point],
            "rescaled_load_sd": law.rescaled_load_sd[point],
            "rescaled_friction": law.rescaled_friction[point],
            "rescaled_friction_sd": law.rescaled_friction_sd[point],
            "predicted": each.predicted,
            "deviation": each.deviation,
            "deviation_sd": each.deviation_sd,
        }
        for name, values in arrays.items():
            over_points.setdefault(name, []).append(values)
    variables: Variables = {name: (("point",), np.concatenate(parts)) for name, parts in over_points.items()}
    of_law = np.repeat(labels, [len(each.point) for each in comparisons])
    variables["of_law"] = ("point",), of_law
    features = [(each.measured.label, feature) for each in comparisons for feature in each.features]
    columns = {
        "of_law_feature": [label for label, _ in features],
        "unit": [feature.unit for _, feature in features],
        "value": [feature.value for _, feature in features],
        "value_sd": [feature.sd for _, feature in features],
        "low": [feature.interval[0] for _, feature in features],
        "high": [feature.interval[1] for _, feature in features],
        "design": [feature.predicted for _, feature in features],
        "target": [feature.target for _, feature in features],
    }
    texts = ("of_law_feature", "unit")
    for name, column in columns.items():
        variables[name] = ("feature",), np.array(column, dtype=str if name in texts else float)
    verdicts = [each.verdict for each in comparisons]
    variables["freedom"] = ("law",), [verdict.freedom for verdict in verdicts]
    for name, probability in (("chi_square", "probability"), ("runs", "runs_probability")):
        variables[name] = ("law",), [verdict[name].statistic for verdict in verdicts]
        variables[probability] = ("law",), [verdict[name].probability for verdict in verdicts]
    variables["fits"] = ("law",), [int(verdict.fits) for verdict in verdicts]
    variables["verdict"] = ("law",), [str(verdict) for verdict in verdicts]
    several = len(comparisons) > 1
    notes = [
        type(note)(f"{each.measured.label}: {note.text}" if several else note.text, note.level)
        for each in comparisons
        for note in each.notes
    ]
    names = np.array([feature.name for _, feature in features], dtype=str)
    study = dataset(
        "measured",
        variables,
        {"feature": names, "law": np.array(labels)},
        model=model,
        inputs=inputs_hash(tuple(comparisons)),
        notes=notes,
    )
    study.attrs["parameters"] = " ".join(
        dict.fromkeys(name for each in comparisons for name in each.parameters)
    )
    return study


def explained(found: Explanation) -> xr.Dataset:
    """Return the explanation of a measured law.

    Parameters
    ----------
    found : metafem.calibration.Explanation

    Returns
    -------
    xarray.Dataset
        Over ``cause``: ``prior_sd``, ``mean`` and ``sd`` [rad or relative], and ``covariance`` over ``cause``
        and ``other_cause``. Over ``group``: ``share`` of the explained misfit, and
        ``misfit_without`` the group. Over ``site``: ``height`` and
        ``radius`` [mm] with ``..._sd``, and ``outlier``; over ``kind``: their ``single_prior_sd`` [mm]. Over
        ``sentence``: the explanation in words. Single numbers are ``misfit_design``, ``misfit`` and
        ``values``, their expected size.

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
    names = [cause.name for cause in found.causes]
    variables: Variables = {
        name: (("cause",), np.array([getattr(cause, name) for cause in found.causes]))
        for name in ("prior_sd", "mean", "sd")
    }
    variables["covariance"] = ("cause", "other_cause"), found.covariance
    variables["share"] = ("group",), np.array(list(found.shares.values()))
    variables["misfit_without"] = ("group",), np.array(list(found.misfit_without.values()))
    variables["sentence_text"] = ("sentence",), np.array(found.sentences())
    kinds = [name for name in ("height", "radius") if name in found.single]
    for name in kinds:
        errors = found.single[name]
        variables |= {name: (("site",), errors.mean), f"{name}_sd": (("site",), errors.sd)}
    if kinds:
        variables["single_prior_sd"] = ("kind",), np.array([found.single[name].prior_sd for name in kinds])
        variables["outlier"] = ("site",), np.isin(np.arange(found.surface.count), found.outliers).astype(int)
    sites = np.arange(found.surface.count) if found.sites is None else found.sites
    for name in ("misfit_design", "misfit"):
        variables[name] = (), getattr(found, name)
    variables["values"] = (), found.count
    return dataset(
        "explained",
        variables,
        {
            "cause": np.array(names, dtype=str),
            "other_cause": np.array(names, dtype=str),
            "group": np.array(list(found.shares), dtype=str),
            "kind": np.array(kinds, dtype=str),
            **({"site": sites} if kinds else {}),
        },
        model=found.model,
        inputs=inputs_hash((found,)),
        notes=found.notes,
    )
