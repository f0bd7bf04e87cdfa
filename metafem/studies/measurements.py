"""Comparisons of measured laws with a design, as the dataset that a result folder keeps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.calibration import Comparison
from metafem.errors import InvalidInput
from metafem.models import Model
from metafem.studies.sampling.dataset import dataset
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
    variables: dict[str, tuple[tuple[str, ...], Any]] = {
        name: (("point",), np.concatenate(parts)) for name, parts in over_points.items()
    }
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
