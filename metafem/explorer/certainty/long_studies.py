"""Studies of the current surface that take seconds to minutes; each runs in a separate process."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from metafem._values import percent
from metafem.errors import InvalidInput, MetafemWarning
from metafem.inversion import Design
from metafem.notes import Note
from metafem.prediction import Tolerances
from metafem.studies.summaries import Summary, summary
from metafem.studies.summaries.comparisons import largest, rms

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

# Standard deviations of the height errors that are studied: multiples of the stated standard deviation of the
# part or, if none is stated, the values of a precise machine and of a common machine [mm].
MULTIPLES, DEVIATIONS = (0.5, 1.0, 2.0), (0.001, 0.003)

# Number of draws; largest tilt [degrees], as in Fig. S2 of the source paper, doi:10.1126/science.adk4234; and
# number of random placements for comparison, as in `metafem study misalignment`.
DRAWS, ANGLE, SHUFFLES = 1000, 0.1, 20

# Width and height of a picture in the tab [inch]: its letters are then as large as those of the page.
SHOWN = 4.0, 2.8

# Loads at which contacts are resolved, as fractions of the largest load.
RESOLVED_LOADS = (0.2, 0.6, 1.0)


@dataclass(frozen=True)
class Found(Summary):
    """The result of a study: its summary and a picture."""

    picture: str = ""  # an SVG element with the colours of the page


@dataclass(frozen=True)
class LongStudy:
    """A study: its title, its question, its duration with 64 asperities, and the function that runs it."""

    title: str
    question: str
    duration: str
    run: Callable[[Design, Tolerances | None], Found]
    hindered: Callable[[Design], str] = lambda design: ""  # why it cannot run; "" if it can

    @property
    def words(self) -> dict[str, str]:
        """What the page shows before the study runs."""
        return {"title": self.title, "question": self.question, "duration": self.duration}


def made_surfaces(design: Design, tolerances: Tolerances | None) -> Found:
    """Study random surfaces with errors in heights, radii and positions; return the scatter of their laws."""
    from metafem.report.study_figures import manufacturing_figure
    from metafem.studies import manufacturing

    stated = replace(tolerances or Tolerances(), angle=0.0)
    levels = [factor * stated.height_sd for factor in MULTIPLES] if stated.height_sd else list(DEVIATIONS)
    study = manufacturing(design.surface, levels, draws=DRAWS, model=design.law.model, others=stated)
    return _found(study, manufacturing_figure({"": study}))


def misaligned(design: Design, tolerances: Tolerances | None) -> Found:
    """Study the tilted surface; return how its law changes with the angle."""
    from metafem.report.study_figures import misalignment_figure
    from metafem.studies import misalignment

    study = misalignment(design.surface, math.radians(ANGLE), model=design.law.model, shuffles=SHUFFLES)
    return _found(study, misalignment_figure({"": study}))


def true_block(design: Design, tolerances: Tolerances | None) -> Found:
    """Compare the laws under all models, including the true block; return the changes of A0."""
    from metafem.report.comparison import compared
    from metafem.report.figures import comparison_figure
    from metafem.studies import fidelity

    study = fidelity(design, elements=False)
    found = _found(study, comparison_figure(compared(design)[0]))
    if "block" not in study.model.values:
        return found
    change = study.area_change.sel(model="block").values
    layer = study.area.sel(model="block").values / study.area.sel(model="layer").values - 1.0
    answer = (
        f"On the true block the interaction changes A0 by {percent(float(rms(change)))} rms and by up to "
        f"{percent(float(largest(change)), '+.2g')}; the bonded layer differs from it by up to "
        f"{percent(abs(float(largest(layer))))}."
    )
    return replace(found, answer=answer)


def resolved(design: Design, tolerances: Tolerances | None) -> Found:
    """Resolve the contacts with boundary elements at a few loads; return the changes of A0."""
    from metafem.files.specification.models import model_named
    from metafem.models import Independent, Interacting
    from metafem.models.model import contact_of
    from metafem.prediction import friction_law
    from metafem.report.comparison import Comparison
    from metafem.report.figures import comparison_figure

    contact = contact_of(design.law.model)
    load = np.array(RESOLVED_LOADS) * design.law.load[-1]
    third = Interacting(order=contact.largest_order, contact=contact)
    models = (Independent(contact=contact), design.law.model, third, model_named("resolved", contact))
    alone, own, order_3, fine = (friction_law(design.surface, model, load=load) for model in models)
    change, apart = fine.area / own.area - 1.0, fine.area / order_3.area - 1.0
    compared = tuple(
        Comparison(name, law, law.area / alone.area - 1.0, alone.separation - law.separation)
        for name, law in (("order 3 on the half-space", order_3), ("resolved contacts", fine))
    )
    columns = {
        "load [N]": [f"{value:.3g}" for value in load],
        "A0 of the design [mm²]": [f"{value:.4g}" for value in own.area],
        "resolved [mm²]": [f"{value:.4g}" for value in fine.area],
        "change [%]": [f"{100.0 * value:+.2f}" for value in change],
        "change from order 3 [%]": [f"{100.0 * value:+.2f}" for value in apart],
    }
    answer = (
        f"With resolved contacts on the half-space A0 differs from the law of this design by up to "
        f"{percent(float(largest(change)), '+.2g')}, and from order 3 of the interaction by up to "
        f"{percent(float(largest(apart)), '+.2g')}."
    )
    picture = _picture(comparison_figure(compared), "Change of A0 by interaction")
    rows = tuple(zip(*columns.values(), strict=True))
    return Found("A0 with resolved contacts", tuple(columns), rows, fine.notes, answer, picture)


def _needs_block(design: Design) -> str:
    return "" if design.surface.block else "It needs “Block” with its width, length and thickness."


def _needs_profile(design: Design) -> str:
    from metafem.models.boundary_elements.model import resolvable
    from metafem.models.model import contact_of

    return "" if resolvable(contact_of(design.law.model)) else "This contact law cannot be resolved."


def _needs_depth(design: Design) -> str:
    level = float(np.ptp(design.surface.height)) == 0.0
    return "All summits have one height, so a slope has no range of loads." if level else ""


STUDIES: dict[str, LongStudy] = {
    "draws": LongStudy(
        f"Draw {DRAWS:,} surfaces", "How accurate must the heights be?", "some seconds", made_surfaces,
        _needs_depth,
    ),
    "misalignment": LongStudy(
        "Misalignment", "How level must the plane be?", "some seconds; a minute with interaction", misaligned,
        _needs_depth,
    ),
    "block": LongStudy(
        "True block", "What does the finite block change?", "a minute the first time, then some seconds",
        true_block, _needs_block,
    ),
    "resolved": LongStudy(
        "Resolved contacts", "What do point contacts leave out?", "ten seconds", resolved, _needs_profile
    ),
}  # fmt: skip


def run(name: str, design: Design, tolerances: Tolerances | None) -> Found:
    """Run a study by name; return its result, with warnings added as notes.

    The function changes the warning filters, so it must run in a separate process.
    """
    reason = STUDIES[name].hindered(design)
    if reason:
        raise InvalidInput(reason)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", MetafemWarning)
        found = STUDIES[name].run(design, tolerances)
    own = [Note(str(each.message)) for each in caught if issubclass(each.category, MetafemWarning)]
    return replace(found, notes=tuple(dict.fromkeys((*found.notes, *own))))


def _found(study: Dataset, figure: Figure) -> Found:
    found = summary(study)
    return Found(**vars(found), picture=_picture(figure, found.title))


def _picture(figure: Figure, title: str) -> str:
    from metafem.drawing.inline import drawn

    figure.set_layout_engine("constrained")
    figure.set_size_inches(*SHOWN)
    return drawn(figure, title).svg
