"""Measured laws: the datasets of comparisons with a design and of explanations, and their summaries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration import Comparison, Explanation
from metafem.calibration.explanation import row
from metafem.calibration.statistics import REJECTED, chi
from metafem.errors import refuse_if
from metafem.models import Model
from metafem.studies.dataset import Summary, Variables, dataset, texts

if TYPE_CHECKING:
    import xarray as xr

# Attributes of a measured law and of its comparison that are stored for each point.
OF_LAW = [f"{name}{sd}" for name in ("load", "rescaled_load", "rescaled_friction") for sd in ("", "_sd")]
OF_POINT = ("predicted", "deviation", "deviation_sd")

# Attributes of a feature by the names of their variables, and those of a verdict.
OF_FEATURE = {"value": "value", "value_sd": "sd", "design": "predicted", "target": "target"}
OF_VERDICT = ("chi_square", "freedom", "probability")

# The probability below which a law is rejected, as text.
LIMIT = percent(REJECTED)


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
    labels = [each.measured.label for each in comparisons]
    words = f"the labels of the measured laws, {labels!r:.80}, must be different"
    refuse_if(not labels or len(set(labels)) < len(labels), words)
    counts = [len(each.point) for each in comparisons]
    features = [(each.measured.label, feature) for each in comparisons for feature in each.features]
    verdicts = [each.verdict for each in comparisons]
    variables: Variables = {
        "of_law": (("point",), np.repeat(labels, counts)),
        "stress": (("point",), np.repeat([each.measured.stress_of_forces for each in comparisons], counts)),
        "of_law_feature": (("feature",), np.array([label for label, _ in features], dtype=str)),
        "fits": (("law",), [int(verdict.fits) for verdict in verdicts]),
        "verdict": (("law",), [str(verdict) for verdict in verdicts]),
    }
    for name in OF_LAW:
        points = [getattr(each.measured, name)[each.point] for each in comparisons]
        variables[name] = ("point",), np.concatenate(points)
    for name in OF_POINT:
        variables[name] = ("point",), np.concatenate([getattr(each, name) for each in comparisons])
    for name, attribute in OF_FEATURE.items():
        values = [getattr(feature, attribute) for _, feature in features]
        variables[name] = ("feature",), np.array(values, dtype=float)
    for name in OF_VERDICT:
        variables[name] = ("law",), [getattr(verdict, name) for verdict in verdicts]
    notes = [
        replace(note, text=f"{each.measured.label}: {note.text}") if len(comparisons) > 1 else note
        for each in comparisons
        for note in each.notes
    ]
    names = np.array([feature.name for _, feature in features], dtype=str)
    parameters = dict.fromkeys(name for each in comparisons for name in each.parameters)
    coordinates = {"feature": names, "law": np.array(labels)}
    origin = {"model": repr(model), "parameters": " ".join(parameters)}
    return dataset("measured", variables, coordinates, notes, **origin)


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
    causes, verdict = np.array(list(found.mean), dtype=str), found.verdict
    variables: Variables = {
        name: (("cause",), np.array(list(getattr(found, name).values())))
        for name in ("expected", "mean", "sd")
    }
    variables |= {
        "covariance": (("cause", "other_cause"), found.covariance),
        "misfit_design": ((), found.misfit_design),
        "misfit": ((), verdict.chi_square),
        "values": ((), verdict.freedom),
        "fits": ((), int(verdict.fits)),
    }
    coordinates = {"cause": causes, "other_cause": causes}
    return dataset("explained", variables, coordinates, [], model=repr(found.model))


def measured_summary(study: xr.Dataset) -> Summary:
    """Return the table of the deviations of all points, and a sentence on each law."""
    # the numbers have the units of the table: friction forces, or areas
    stress = study["stress"].values if "stress" in study else np.zeros(1)
    factor, what = (stress, " F [N]") if (stress > 0.0).all() else (1.0, " area [mm²]")
    names = ("rescaled_friction", "rescaled_friction_sd", "predicted")
    value, sd, design = (factor * study[name].values for name in names)
    deviation = (study["deviation"] / study["deviation_sd"]).values
    columns: dict[str, Any] = {"law": study["of_law"].values, "P [N]": texts(".4g", study["load"].values)}
    columns |= _deviations(value, sd, design, deviation, what)
    return Summary.of(study, "Measured law and design", columns, " ".join(answers(study)))


def features(study: xr.Dataset) -> Summary:
    """Return the table of slopes, with deviations from design and target."""
    value, sd, design, target = (study[name].values for name in OF_FEATURE)
    columns: dict[str, Any] = {"law": study["of_law_feature"].values, "feature": study["feature"].values}
    columns |= _deviations(value, sd, design, (value - design) / sd)
    columns |= {"target": texts(".4g", target), "from target": _relative(value, target)}
    return Summary.of(study, "Features of the target", columns)


def _deviations(
    value: FloatArray, sd: FloatArray, design: FloatArray, deviation: FloatArray, what: str = ""
) -> dict[str, list[str]]:
    """Return the columns that compare measured values with those of a design, by their headings."""
    return {
        f"measured{what}": texts(".4g", value),
        "±": texts(".2g", sd),
        f"design{what}": texts(".4g", design),
        "deviation": _relative(value, design),
        "in s.d.": texts("+.1f", deviation),
    }


def answers(study: xr.Dataset) -> list[str]:
    """Return one sentence for each law: its deviation and whether it agrees with the design."""
    found = []
    for i in range(study.sizes["law"]):
        one = study.isel(law=i)
        label = str(one["law"].item())
        points = study.isel(point=np.flatnonzero(study["of_law"].values == label))
        ratio = (points["deviation"] / points["predicted"]).values[points["predicted"].values > 0.0]
        rms = percent(float(np.sqrt((ratio**2).mean()))) if ratio.size else "unknown"
        agrees, rejected = ("agrees", "not rejected") if int(one["fits"]) else ("does not agree", "rejected")
        found.append(
            f"The {label} law {agrees} with the design within its error bars ({rejected} at {LIMIT}): "
            f"rms deviation {rms}, {one['verdict'].item()}."
        )
    return found


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
    answer = (
        f"A part with these errors {explains} with the {count:.0f} measured values: chi² = {chi(misfit)}."
    )
    return Summary.of(study, "What explains the measured law", columns, answer)
