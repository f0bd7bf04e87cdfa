"""Curves beside the law: the tolerance band and the laws under further models."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.certainty.background import Tasks
from metafem.explorer.certainty.band import EVERY, band_words, tolerance_band
from metafem.explorer.law.law_data import band_data
from metafem.explorer.law.shown import Units
from metafem.explorer.queue import Queue, in_words
from metafem.files import chosen_model
from metafem.inversion import Design
from metafem.prediction import friction_law

# Models whose laws take milliseconds, and the model whose law is computed in a separate process that takes
# between seconds and a minute the first time.
QUICK, SLOW = ("independent", "half-space", "layer"), "block"

# Why the axes cannot be in newtons, and why the law under the block model cannot be computed.
NO_FORCES = "Newtons need “Friction” with its shear strength and area ratio in the workshop."
NO_BLOCK = "The block model needs “Block” with its width, length and thickness in the workshop."


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
    names = (*QUICK, SLOW)
    return next((name for name in names if chosen_model(model, name, None) == model), "")


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
    """Return the axes and models that can be chosen above the plot, and the current choices.

    ``block`` says whether the law under the block model is a further law.
    """
    design = answer.design
    forces = design is not None and design.template.friction is not None
    own = "" if design is None else own_name(design)
    return {
        "newtons": answer.state.newtons,
        "no_forces": "" if forces else NO_FORCES,
        "models": [{"name": name, "on": name in answer.state.models} for name in QUICK if name != own],
        "block": own != SLOW,
    }


class Block:
    """The law under the block model, computed in a process that can be stopped."""

    def __init__(self, tasks: Tasks, changed: Callable[[], None]) -> None:
        self.tasks, self.changed = tasks, changed
        self.design: Design | None = None
        self.law: Other | None = None
        self.step = ""

    async def start(self, design: Design) -> None:
        """Compute the law of a design."""
        self.design, self.law, self.step = design, None, "starting"
        task = self.tasks.start(SLOW, other_law, (design, SLOW), self._stepped)
        self.changed()
        try:
            self.law = await task
        except MetafemError as error:
            self.law = Other(SLOW, error=f"{SLOW}: {error}")
        self.changed()

    def stop(self) -> None:
        """Stop the computation, and remove its law from the plot."""
        self.tasks.stop(SLOW)
        self.design = self.law = None
        self.changed()

    def of(self, design: Design | None) -> Other | None:
        """Return the law of a design; None if no law was computed for this design."""
        # after undo, an equal design is a different object
        same = self.design is not None and (design is self.design or design == self.design)
        return self.law if same else None

    def data(self, design: Design | None) -> dict[str, Any]:
        """Return whether the computation runs, its step, whether its law is shown, and what it needs."""
        running = self.tasks.running(SLOW)
        return {
            "running": running,
            "step": f"The law under the block: {self.step} …" if running else "",
            "shown": self.of(design) is not None,
            "missing": "" if design is not None and design.template.block is not None else NO_BLOCK,
        }

    def _stepped(self, name: str, done: float | None) -> None:
        self.step = name if done is None else f"{name}, {percent(done)}"
        self.changed()


@dataclass(frozen=True, eq=False)
class More:
    """What is shown beside the law of an answer: further laws, and data of the band."""

    answer: Answer
    laws: tuple[Other, ...]
    data: Mapping[str, Any]


class Further:
    """Computes in a thread the further curves of the newest answer, and passes them to the plot."""

    def __init__(self, tasks: Tasks, draw: Callable[[dict[str, Any]], None]) -> None:
        self.draw = draw
        self.newest: Queue[Answer, More] = Queue(self._computed, self._show, self._failed)
        self.block = Block(tasks, self._renew)
        self.last: More | None = None

    def put(self, answer: Answer) -> None:
        """Compute the further curves of an answer, unless a newer answer replaces it."""
        if answer.design is not None:
            self.newest.put(answer)

    def _computed(self, answer: Answer) -> More:
        """Return the further curves of an answer; laws already shown for the same design are reused."""
        design, last = answer.design, self.last
        assert design is not None
        shown = last.laws if last is not None and last.answer.design is design else ()
        known = {law.name: law for law in shown}
        names = [name for name in QUICK if name in answer.state.models and name != own_name(design)]
        laws = tuple(known.get(name) or other_law(design, name) for name in names)
        band, units = tolerance_band(answer), Units.of_design(answer, answer.state.newtons)
        data = None if band is None else band_data(band, units, name=band_words(answer))
        return More(answer, laws, {"tolerance": data})

    def _show(self, more: More) -> None:
        self.last = more
        self._renew()

    def _failed(self, answer: Answer, error: Exception) -> None:
        """Show the error, and no further curves of the answer."""
        self._show(More(answer, (Other("", error=in_words(error)),), {"tolerance": None}))

    def _renew(self) -> None:
        """Draw the curves that are known."""
        more = self.last
        if more is None:
            return
        units, block = Units.of_design(more.answer, more.answer.state.newtons), self.block
        laws = [law for law in (*more.laws, block.of(more.answer.design)) if law is not None]
        self.draw(
            {
                **more.data,
                "number": more.answer.number,
                "others": [
                    units.curve(law.load, law.friction) | {"name": law.words} for law in laws if not law.error
                ],
                "errors": [law.error for law in laws if law.error],
                "block": block.data(more.answer.design),
            }
        )
