"""Summaries of measured laws: agreement with the design, and errors that explain the difference."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration.diagnosis.causes import GROUPS
from metafem.calibration.diagnosis.sentences import NAMES, amount, interval, part, spread
from metafem.calibration.verdict import REJECTED, chi
from metafem.studies.summaries.table import Columns, Summary, stored_notes, summarised, texts

if TYPE_CHECKING:
    from xarray import Dataset

# The probability below which a law is rejected, as text.
LIMIT = percent(REJECTED)

# Text that replaces the share of a group in the rows of the group after its first row.
WITH = "(with x)"

CAUSES = ("cause", "expected", "found (68 %)", "share of the misfit", "chi² without it")


def measured_summary(study: Dataset) -> Summary:
    """Return the table of the deviations of all points, and a sentence on each law."""
    measured, predicted = study["rescaled_friction"].values, study["predicted"].values
    columns: Columns = {
        "law": study["of_law"].values,
        "P [N]": texts(".4g", study["load"].values),
        "P/E* [mm²]": texts(".4g", study["rescaled_load"].values),
        "measured [mm²]": texts(".4g", measured),
        "±": texts(".2g", study["rescaled_friction_sd"].values),
        "design [mm²]": texts(".4g", predicted),
        "deviation": _relative(measured, predicted),
        "in s.d.": texts("+.1f", (study["deviation"] / study["deviation_sd"]).values),
    }
    return summarised(study, "Measured law and design", columns, " ".join(answers(study)))


def features(study: Dataset) -> Summary:
    """Return the table of slopes, operating points and crossovers, with deviations from design and target."""
    value, sd, design, target = (study[name].values for name in ("value", "value_sd", "design", "target"))
    units = study["unit"].values.tolist()
    columns: Columns = {
        "law": study["of_law_feature"].values,
        "feature": study["feature"].values,
        "measured": [f"{each:.4g} {unit}".rstrip() for each, unit in zip(value, units, strict=True)],
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
        freedom, runs = int(one["freedom"]), int(one["runs"])
        agrees, rejected = ("agrees", "not rejected") if int(one["fits"]) else ("does not agree", "rejected")
        found.append(
            f"The {label} law {agrees} with the design within its error bars ({rejected} at {LIMIT}): "
            f"rms deviation {rms}, "
            f"chi² = {chi(float(one['chi_square']))} with {freedom} degree{'s' * (freedom != 1)} of freedom "
            f"(p = {float(one['probability']):.2g}), {runs} run{'s' * (runs != 1)} of deviations "
            f"(p = {float(one['runs_probability']):.2g})."
        )
    return found


def _relative(value: FloatArray, reference: FloatArray) -> list[str]:
    """Return relative differences as texts; "-" where the reference is not positive."""
    pairs = zip(value.tolist(), reference.tolist(), strict=True)
    return [percent(one / other - 1.0, "+.1f") if other > 0.0 else "-" for one, other in pairs]


def explained_summary(study: Dataset) -> Summary:
    """Return the table of errors with their shares of the misfit, the largest first, and sentences."""
    rows: list[tuple[str, ...]] = []
    for group in study["group"].values.tolist():
        whole = study.sel(group=group)
        last = part(float(whole["share"])), chi(float(whole["misfit_without"]))
        for name in GROUPS[group]:
            if name in study["cause"].values:
                prior, mean, sd = (float(study[each].sel(cause=name)) for each in ("prior_sd", "mean", "sd"))
                found = interval(name, mean, sd)
            elif name in study["kind"].values:
                found = spread(name, study[name].values, study[f"{name}_sd"].values)
                prior = float(study["single_prior_sd"].sel(kind=name))
            else:
                continue
            rows.append((NAMES[name], f"0 ± {amount(name, prior, '.2g')}", found, *last))
            last = WITH, WITH
    title, answer = "What explains the measured law", " ".join(sentences(study))
    return Summary(title, CAUSES, tuple(rows), stored_notes(study), answer)


def sentences(study: Dataset) -> list[str]:
    """Return the explanation in sentences."""
    return [str(text) for text in study["sentence_text"].values]
