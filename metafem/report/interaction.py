"""The laws of a design under the common models of elastic interaction."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from metafem._values import MICROMETRES, percent
from metafem.drawing import ACHIEVED, MARGINS, QUIET, finished, new_figure
from metafem.inversion import Design
from metafem.models.model import contact_of
from metafem.notes import Note
from metafem.prediction import FrictionLaw
from metafem.studies.models import laws_on_substrates

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Largest number of asperities for which interacting laws are compared. Up to this number, a report takes a
# second or two.
MOST_COMPARED = 1500


def compared(design: Design) -> tuple[dict[str, FrictionLaw], tuple[Note, ...]]:
    """Return the laws of a design by the names of their models, the independent one first, and notes.

    The models are independent asperities, asperities on the half-space and, with a block, on the bonded layer
    and the true block. The design's own law is added if its model is a different one. The true block is
    included only if its influence has been computed before. The notes state which models are left out.
    Surfaces of more than 1,500 asperities are not compared.
    """
    own = design.law
    if design.surface.count > MOST_COMPARED:
        return {}, ()
    contact = contact_of(own.model)
    found, notes = laws_on_substrates(design.surface, own.load, contact, wait=False)
    # all have the same contacts, so that their names go without them
    laws = {law.model.name.replace(f", {contact!r}", ""): law for law in (*found.values(), own)}
    return (laws if len(laws) > 1 else {}), tuple(notes)


def interaction_figure(laws: Mapping[str, FrictionLaw]) -> Figure:
    """Draw the change of A0 by elastic interaction, in percent of the independent law, against the load."""
    figure = new_figure(7.0, 3.0, MARGINS)
    ax = figure.add_subplot()
    ax.axhline(0.0, color=QUIET, lw=0.8)
    (_, independent), *others = laws.items()
    for (name, law), style in zip(others, cycle(("-", "--", ":")), strict=False):
        change = 100.0 * (law.area / independent.area - 1.0)
        ax.plot(law.rescaled_load, change, style, color=ACHIEVED, label=name)
    ax.set(xlabel="rescaled load  P/E* [mm²]", ylabel="change of A0 [%]")
    ax.set_xlim(left=0.0)
    return finished(figure)


def interaction_rows(laws: Mapping[str, FrictionLaw]) -> list[tuple[str, ...]]:
    """Return the model, the rms and the largest change of A0, and the decrease of the last separation."""
    rows: list[tuple[str, ...]] = []
    (_, independent), *others = laws.items()
    for name, law in others:
        change = law.area / independent.area - 1.0
        sinking = MICROMETRES * (independent.separation - law.separation)[-1]
        rms, largest = np.sqrt((change**2).mean()), change[np.abs(change).argmax()]
        rows.append((name, percent(rms, ".2f"), percent(largest, "+.2f"), f"{sinking:.1f} µm"))
    return rows
