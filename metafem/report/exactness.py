"""The report's section on how exact the part must be, from the studies of the design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from metafem.drawing import svg
from metafem.report.study_figures import Labelled, misalignment_figure
from metafem.studies.summaries import summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

# What each study answers, the title of its figure, and the figure.
QUESTIONS: Mapping[str, tuple[str, str, Callable[[Labelled], Figure]]] = {
    "misalignment": (
        "How level must the plane be?",
        "Scatter of the slope against the tilt of the plane",
        misalignment_figure,
    ),
}

# Figs. S2 and S3 of the source (doi:10.1126/science.adk4234) show slopes without the loads of their fits.
SOURCE = "This range is metafem's choice; the source paper does not print its own."


def exactness_section(studies: Mapping[str, Dataset]) -> dict[str, Any]:
    """Return the answers of the studies, with tables and figures, and the commands of the missing ones."""
    answers, missing = [], []
    for name, (question, title, figure) in QUESTIONS.items():
        if name not in studies:
            missing.append((question, f"metafem study {name} DIR"))
            continue
        table = summary(studies[name])
        answers.append(
            {
                **vars(table),
                "question": question,
                "figure": svg(figure({"": studies[name]}), title),
            }
        )
    return {"answers": answers, "missing": missing, "fitted": _fitted(studies)}


def _fitted(studies: Mapping[str, Dataset]) -> str:
    """Return over which loads the slopes are fitted."""
    stated = [study.attrs["load_range"] for study in studies.values() if "load_range" in study.attrs]
    ranges = {tuple(map(float, each)) for each in stated}
    words = " and ".join(f"{low:.4g} to {high:.4g} mm²" for low, high in sorted(ranges))
    return f"Slopes are fitted over the rescaled loads P/E* = {words}. {SOURCE}" if words else ""
