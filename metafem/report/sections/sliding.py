"""The section of the report on the onset of sliding, and its words and data."""

from __future__ import annotations

from typing import Any

from metafem._values import MICROMETRES, three_digits
from metafem.drawing import finished, new_figure
from metafem.drawing.inline import drawn
from metafem.inversion import Design
from metafem.prediction import Onset, onset
from metafem.report.figures import MARGINS


def sliding_section(design: Design) -> dict[str, Any] | None:
    """Return the figure and the words of the onset of sliding at the largest load; None without friction."""
    if design.surface.friction is None:
        return None
    sliding = onset(design.surface, design.law.model, load=float(design.law.load[-1]))
    figure = new_figure(7.0, 3.2, MARGINS)
    sliding.plot(figure.subplots())
    return {"figure": drawn(finished(figure), "Onset of sliding"), "words": onset_words(sliding)}


def onset_words(sliding: Onset) -> str:
    """Return the result of an onset of sliding in one sentence."""
    count, first = len(sliding.displacement), three_digits(MICROMETRES * sliding.displacement[0])
    end = f"{three_digits(MICROMETRES * sliding.sliding_displacement)} µm"
    slip = (
        f"the only contact slides from {end} on"
        if count == 1
        else f"the first of {count} contacts slides from {first} µm on, and all slide from {end} on"
    )
    force = three_digits(float(sliding.friction_force[-1]))
    return (
        f"At a load of {three_digits(sliding.state.load)} N, {slip}, at {force} N; before, the tangential "
        f"stiffness is {three_digits(sliding.stiffness)} N/mm"
    )


def onset_data(sliding: Onset) -> dict[str, Any]:
    """Return an onset of sliding as plain data for JSON, with units in the keys."""
    return {
        "load_N": float(sliding.state.load),
        "sliding_displacement_mm": sliding.sliding_displacement,
        "stiffness_N_per_mm": sliding.stiffness,
        "displacement_mm": sliding.displacement.tolist(),
        "friction_force_N": sliding.friction_force.tolist(),
        "asperity": sliding.asperity.tolist(),
    }
