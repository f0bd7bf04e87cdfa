"""The report's section on the required accuracy of the part, from the studies of the design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from metafem.drawing.inline import drawn
from metafem.report.study_figures import (
    manufacturing_figure,
    misalignment_figure,
    uncertainty_figure,
)
from metafem.studies.summary import summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset


class Question(NamedTuple):
    """A question, the command of the study that answers it, and the study's figure with title and caption."""

    text: str
    command: str
    title: str
    figure: Callable[[Dataset], Figure]
    caption: str


QUESTIONS: Mapping[str, Question] = {
    "manufacturing": Question(
        "How accurate must the heights be?",
        "metafem study manufacturing DIR",
        "Slope against the errors of the heights",
        lambda study: manufacturing_figure({"": study}),
        "Mean slope over the nominal one, with bars of one standard deviation, against errors of heights.",
    ),
    "misalignment": Question(
        "How level must the plane be?",
        "metafem study misalignment DIR",
        "Scatter of the slope against the tilt of the plane",
        lambda study: misalignment_figure({"": study}),
        "Standard deviation of the slope over the nominal slope against the largest angle of the plane.",
    ),
    "uncertainty": Question(
        "Which input matters most?",
        "metafem study uncertainty DIR --sd composite_modulus=0.04MPa --sd radius=2um",
        "Error bars of the law and the share of each input",
        uncertainty_figure,
        "Left: the law with bars of one standard deviation. Right: the share of each input in the variance.",
    ),
}

# Figs. S2 and S3 of the source paper (doi:10.1126/science.adk4234) show slopes, but the paper does not state
# the loads of the fits.
SOURCE = (
    "The default, 25 to 100 % of the load at which the plane reaches the lowest asperity, is the choice of "
    "metafem; the source paper does not print its range."
)


def exactness_section(studies: Mapping[str, Dataset]) -> dict[str, Any]:
    """Return the answers of the studies, with tables and figures, and the commands of the missing studies."""
    answers = []
    for name in [name for name in QUESTIONS if name in studies]:
        text, _, title, draw, caption = QUESTIONS[name]
        picture = drawn(draw(studies[name]), title, caption)
        answers.append({**vars(summary(studies[name])), "question": text, "figure": picture})
    missing = [(each.text, each.command) for name, each in QUESTIONS.items() if name not in studies]
    return {"answers": answers, "missing": missing, "fitted": _fitted(studies)}


def _fitted(studies: Mapping[str, Dataset]) -> str:
    """Return a sentence on the loads over which slopes are fitted; empty if no study has a slope."""
    # studies that compare models have no slope, and their range is empty
    stated = [study.attrs.get("load_range", ()) for study in studies.values()]
    ranges = {tuple(map(float, each)) for each in stated if len(each)}
    words = " and ".join(f"{low:.4g} to {high:.4g} mm²" for low, high in sorted(ranges))
    return f"Slopes are fitted over the rescaled loads P/E* = {words}. {SOURCE}" if words else ""
