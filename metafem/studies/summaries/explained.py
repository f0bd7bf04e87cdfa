"""Which errors explain a measured law: the summary of an explanation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.calibration.diagnosis.causes import GROUPS
from metafem.calibration.diagnosis.sentences import NAMES, amount, part, spread
from metafem.calibration.verdict import chi
from metafem.studies.summaries.table import Summary, stored_notes

if TYPE_CHECKING:
    from xarray import Dataset

# The share of a second error of one group.
WITH = "(with x)"

COLUMNS = ("cause", "expected", "found (68 %)", "share of the misfit", "chi² without it")


def explained_summary(study: Dataset) -> Summary:
    """Return the errors with their shares of the misfit, the largest first, and what they say."""
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
                found = f"{amount(name, mean)} ± {amount(name, sd, '.2g')}"
                prior = float(one["prior_sd"])
            elif name in study["kind"].values:
                found = spread(name, study[name].values, study[f"{name}_sd"].values)
                prior = float(study["single_prior_sd"].sel(kind=name))
            else:
                continue
            rows.append((NAMES[name], f"0 ± {amount(name, prior, '.2g')}", found, *last))
            last = WITH, WITH
    return Summary(
        "What explains the measured law", COLUMNS, tuple(rows), stored_notes(study), " ".join(answers(study))
    )


def answers(study: Dataset) -> list[str]:
    """Return the explanation in sentences."""
    return [str(text) for text in study["sentence_text"].values]
