"""Curves beside the law: the tolerance band and the laws under further models."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.certainty.band import EVERY, band_words, tolerance_band
from metafem.explorer.law.law_data import band_data
from metafem.explorer.law.shown import Units
from metafem.explorer.queue import Queue, in_words
from metafem.files import chosen_model
from metafem.inversion import Design
from metafem.prediction import friction_law

# Models whose laws take milliseconds.
QUICK = ("independent", "half-space", "layer")

# Why the axes cannot be in newtons.
NO_FORCES = "Newtons need “Friction” with its shear strength and area ratio in the workshop."


@dataclass(frozen=True, eq=False)
class Other:
    """The law of a surface under a further model, or the reason why it could not be computed."""

    name: str
    load: FloatArray = field(default_factory=lambda: np.empty(0))  # rescaled [mm^2]
    friction: FloatArray = field(default_factory=lambda: np.empty(0))  # rescaled [mm^2]
    difference: float = 0.0  # rms of the relative differences from the law of the design
    error: str = ""

    @property
    def words(self) -> str:
        """Label of the curve: the model, and the difference of its law from the law of the design."""
        return f"{self.name}, differs by {percent(self.difference)} (rms)"


def own_name(design: Design) -> str:
    """Return the name of the design's model in specifications; "" if no name selects exactly this model."""
    model = design.law.model
    return next((name for name in QUICK if chosen_model(model, name, None) == model), "")


def other_law(design: Design, name: str) -> Other:
    """Return the law of a design's surface under another model with the same contact law."""
    model = chosen_model(design.law.model, name, None)
    try:
        law = friction_law(design.surface, model, load=design.law.load[::-EVERY][::-1])
    except MetafemError as error:
        return Other(name, error=f"{name}: {error}")
    own = design.law.rescaled_friction[::-EVERY][::-1]
    difference = float(np.sqrt(((law.rescaled_friction / own - 1.0) ** 2).mean()))
    return Other(name, law.rescaled_load, law.rescaled_friction, difference)


def tools_data(answer: Answer) -> dict[str, Any]:
    """Return the axes and models that can be chosen above the plot, and the current choices."""
    design = answer.design
    forces = design is not None and design.template.friction is not None
    own = "" if design is None else own_name(design)
    return {
        "newtons": answer.state.newtons,
        "no_forces": "" if forces else NO_FORCES,
        "models": [{"name": name, "on": name in answer.state.models} for name in QUICK if name != own],
    }


class Further:
    """Computes in a thread the further curves of the newest answer, and passes them to the plot."""

    def __init__(self, draw: Callable[[dict[str, Any]], None]) -> None:
        self.newest: Queue[Answer, dict[str, Any]] = Queue(
            self._computed, draw, lambda answer, error: draw(_data(answer, errors=[in_words(error)]))
        )
        self.known: tuple[Design | None, dict[str, Other]] = None, {}

    def put(self, answer: Answer) -> None:
        """Compute the further curves of an answer, unless a newer answer replaces it."""
        if answer.design is not None:
            self.newest.put(answer)

    def _computed(self, answer: Answer) -> dict[str, Any]:
        """Return the further curves of an answer; laws already known for the same design are reused."""
        design, known = answer.design, self.known[1]
        assert design is not None
        if design is not self.known[0]:
            known = {}
        names = [name for name in QUICK if name in answer.state.models and name != own_name(design)]
        laws = [known.get(name) or other_law(design, name) for name in names]
        self.known = design, {law.name: law for law in laws}
        band, units = tolerance_band(answer), Units.of_design(answer, answer.state.newtons)
        return _data(
            answer,
            tolerance=None if band is None else band_data(band, units, name=band_words(answer)),
            others=[
                units.curve(law.load, law.friction) | {"name": law.words} for law in laws if not law.error
            ],
            errors=[law.error for law in laws if law.error],
        )


def _data(answer: Answer, **found: Any) -> dict[str, Any]:
    return {"number": answer.number, "tolerance": None, "others": [], "errors": [], **found}
