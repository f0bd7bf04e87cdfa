"""The report's section on the errors of the part that explain its measured law."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from metafem._values import MICROMETRES
from metafem.calibration.diagnosis.sentences import NAMES
from metafem.drawing import diagnosis, new_figure
from metafem.drawing.inline import drawn
from metafem.studies.summaries.measurements import explained_summary, sentences

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

# Margins of the two figures, on the left, on the right, below and above [inch]; the names of the errors need
# more space on the left.
WIDE, NARROW = (1.3, 0.2, 0.6, 0.4), (0.9, 0.2, 0.6, 0.2)

ERRORS = "Errors of the whole part that explain its law, over the standard deviations expected before."
HEIGHTS = "Errors of single heights that explain the law, with their standard deviations."


def explanation_section(studies: Mapping[str, Dataset]) -> dict[str, Any] | None:
    """Return the sentences, the table and the figures of the explanation, or None if there is none."""
    if "explained" not in studies:
        return None
    study = studies["explained"]
    figures = []
    if study.sizes["cause"]:
        figures.append(drawn(errors_figure(study), "Errors of the part over their expected sizes", ERRORS))
    if "height" in study["kind"].values:
        figures.append(drawn(heights_figure(study), "Errors of single heights", HEIGHTS))
    return {**vars(explained_summary(study)), "answers": sentences(study), "figures": figures}


def errors_figure(study: Dataset) -> Figure:
    """Draw the errors of the whole part over their prior standard deviations."""
    figure = new_figure(7.0, 1.4 + 0.35 * study.sizes["cause"], WIDE)
    labels = [NAMES[name] for name in study["cause"].values.tolist()]
    mean, sd = ((study[name] / study["prior_sd"]).values for name in ("mean", "sd"))
    diagnosis.posteriors(figure.add_subplot(), labels, mean, sd)
    return figure


def heights_figure(study: Dataset) -> Figure:
    """Draw the errors of single heights with their standard deviations."""
    figure = new_figure(7.0, 2.8, NARROW)
    prior = float(study["single_prior_sd"].sel(kind="height"))
    mean, sd = (MICROMETRES * study[name].values for name in ("height", "height_sd"))
    diagnosis.heights(figure.add_subplot(), mean, sd, MICROMETRES * prior)
    return figure
