"""Summaries of measured laws: agreement with the design, and errors that explain the difference."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._values import percent
from metafem.calibration.diagnosis.causes import GROUPS
from metafem.calibration.diagnosis.sentences import NAMES, amount, interval, part, spread
from metafem.calibration.verdict import REJECTED, chi
from metafem.studies.summaries.table import Summary, stored_notes

if TYPE_CHECKING:
    from xarray import Dataset

# The probability below which a law is rejected.
LIMIT = percent(REJECTED)

# Columns of the tables of points and of features.
POINTS = ("law", "P [N]", "P/E* [mm²]", "measured [mm²]", "±", "design [mm²]", "deviation", "in s.d.")
FEATURES = ("law", "feature", "measured", "±", "design", "deviation", "in s.d.", "target", "from target")


# The share of a second error of one group.
WITH = "(with x)"

CAUSES = ("cause", "expected", "found (68 %)", "share of the misfit", "chi² without it")


def measured_summary(study: Dataset) -> Summary:
    """Return the deviations of all points, and a sentence on each law."""
    rows = [
        (
            str(point["of_law"].item()),
            f"{float(point['load']):.4g}",
            f"{float(point['rescaled_load']):.4g}",
            f"{float(point['rescaled_friction']):.4g}",
            f"{float(point['rescaled_friction_sd']):.2g}",
            f"{float(point['predicted']):.4g}",
            _relative(float(point["rescaled_friction"]), float(point["predicted"])),
            f"{float(point['deviation'] / point['deviation_sd']):+.1f}",
        )
        for point in (study.isel(point=i) for i in range(study.sizes["point"]))
    ]
    answer = " ".join(answers(study))
    return Summary("Measured law and design", POINTS, tuple(rows), stored_notes(study), answer)


def feature_rows(study: Dataset) -> list[tuple[str, ...]]:
    """Return the slopes, operating points and crossovers, with their deviations from design and target."""
    rows: list[tuple[str, ...]] = []
    for i in range(study.sizes["feature"]):
        one = study.isel(feature=i)
        value, sd, design, target = (float(one[name]) for name in ("value", "value_sd", "design", "target"))
        unit = f" {one['unit'].item()}".rstrip()
        rows.append(
            (
                str(one["of_law_feature"].item()),
                str(one["feature"].item()),
                f"{value:.4g}{unit}",
                f"{sd:.2g}",
                f"{design:.4g}",
                _relative(value, design),
                f"{(value - design) / sd:+.1f}",
                f"{target:.4g}",
                _relative(value, target),
            )
        )
    return rows


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
            f"(p = {float(one['probability']):.2g}), {counted_runs(int(one['runs']))} of deviations "
            f"(p = {float(one['runs_probability']):.2g})."
        )
    return found


def counted_runs(runs: int) -> str:
    """Return a number of runs in words."""
    return "1 run" if runs == 1 else f"{runs} runs"


def _relative(value: float, reference: float) -> str:
    return percent(value / reference - 1.0, "+.1f") if reference > 0.0 else "-"


def explained_summary(study: Dataset) -> Summary:
    """Return the errors with their shares of the misfit, the largest first, and a sentence."""
    rows: list[tuple[str, ...]] = []
    for group in study["group"].values.tolist():
        last = (
            part(float(study["share"].sel(group=group))),
            chi(float(study["misfit_without"].sel(group=group))),
        )
        for name in GROUPS[group]:
            if name in study["cause"].values:
                one = study.sel(cause=name)
                mean, sd = float(one["mean"]), float(one["sd"])
                found = interval(name, mean, sd)
                prior = float(one["prior_sd"])
            elif name in study["kind"].values:
                found = spread(name, study[name].values, study[f"{name}_sd"].values)
                prior = float(study["single_prior_sd"].sel(kind=name))
            else:
                continue
            rows.append((NAMES[name], f"0 ± {amount(name, prior, '.2g')}", found, *last))
            last = WITH, WITH
    return Summary(
        "What explains the measured law",
        CAUSES,
        tuple(rows),
        stored_notes(study),
        " ".join(sentences(study)),
    )


def sentences(study: Dataset) -> list[str]:
    """Return the explanation in sentences."""
    return [str(text) for text in study["sentence_text"].values]
