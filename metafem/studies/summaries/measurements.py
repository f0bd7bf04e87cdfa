"""Summaries of measured laws: agreement with the design, and errors that explain the difference."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration.explanation import row
from metafem.calibration.statistics import REJECTED, chi
from metafem.studies.summaries.table import Columns, Summary, stored_notes, summarised, texts

if TYPE_CHECKING:
    from xarray import Dataset

# The probability below which a law is rejected, as text.
LIMIT = percent(REJECTED)

CAUSES = ("cause", "found (68 %)", "expected")


def measured_summary(study: Dataset) -> Summary:
    """Return the table of the deviations of all points, and a sentence on each law."""
    measured, predicted = study["rescaled_friction"].values, study["predicted"].values
    # the numbers have the units of the table: friction forces, or areas
    stress = study["stress"].values if "stress" in study else np.zeros(1)
    factor, what = (stress, "F [N]") if (stress > 0.0).all() else (1.0, "area [mm²]")
    columns: Columns = {
        "law": study["of_law"].values,
        "P [N]": texts(".4g", study["load"].values),
        f"measured {what}": texts(".4g", factor * measured),
        "±": texts(".2g", factor * study["rescaled_friction_sd"].values),
        f"design {what}": texts(".4g", factor * predicted),
        "deviation": _relative(measured, predicted),
        "in s.d.": texts("+.1f", (study["deviation"] / study["deviation_sd"]).values),
    }
    return summarised(study, "Measured law and design", columns, " ".join(answers(study)))


def features(study: Dataset) -> Summary:
    """Return the table of slopes, with deviations from design and target."""
    value, sd, design, target = (study[name].values for name in ("value", "value_sd", "design", "target"))
    columns: Columns = {
        "law": study["of_law_feature"].values,
        "feature": study["feature"].values,
        "measured": texts(".4g", value),
        "±": texts(".2g", sd),
        "design": texts(".4g", design),
        "deviation": _relative(value, design),
        "in s.d.": texts("+.1f", (value - design) / sd),
        "target": texts(".4g", target),
        "from target": _relative(value, target),
    }
    return summarised(study, "Features of the target", columns)


def answers(study: Dataset) -> list[str]:
    """Return one sentence for each law: its deviation and whether it agrees with the design."""
    found = []
    for i in range(study.sizes["law"]):
        one = study.isel(law=i)
        label = str(one["law"].item())
        points = study.isel(point=np.flatnonzero(study["of_law"].values == label))
        ratio = (points["deviation"] / points["predicted"]).values[points["predicted"].values > 0.0]
        rms = percent(float(np.sqrt((ratio**2).mean()))) if ratio.size else "unknown"
        freedom = int(one["freedom"])
        agrees, rejected = ("agrees", "not rejected") if int(one["fits"]) else ("does not agree", "rejected")
        found.append(
            f"The {label} law {agrees} with the design within its error bars ({rejected} at {LIMIT}): "
            f"rms deviation {rms}, "
            f"chi² = {chi(float(one['chi_square']))} with {freedom} degree{'s' * (freedom != 1)} of freedom "
            f"(p = {float(one['probability']):.2g})."
        )
    return found


def _relative(value: FloatArray, reference: FloatArray) -> list[str]:
    """Return relative differences as texts; "-" where the reference is not positive."""
    pairs = zip(value.tolist(), reference.tolist(), strict=True)
    return [percent(one / other - 1.0, "+.1f") if other > 0.0 else "-" for one, other in pairs]


def explained_summary(study: Dataset) -> Summary:
    """Return the table of the errors that explain a law, and a sentence on the misfit."""
    columns = [study[name].values.tolist() for name in ("cause", "mean", "sd", "expected")]
    rows = tuple(row(*values) for values in zip(*columns, strict=True))
    misfit, values = float(study["misfit"]), float(study["values"])
    explains = "agrees" if int(study["fits"]) else "does not agree"
    answer = (
        f"A part with these errors {explains} with the {values:.0f} measured values: chi² = {chi(misfit)}."
    )
    return Summary("What explains the measured law", CAUSES, rows, stored_notes(study), answer)
