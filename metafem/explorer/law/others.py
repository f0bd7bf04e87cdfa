"""Laws of the current surface under further models."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.errors import MetafemError
from metafem.explorer.certainty.background import Tasks
from metafem.files import chosen_model
from metafem.inversion import Design
from metafem.prediction import friction_law

# Models whose laws take milliseconds, and the model whose law is computed in a separate process that takes
# between seconds and a minute the first time.
QUICK, SLOW = ("independent", "half-space", "layer"), "block"

# The further laws are solved at every n-th load of the design's law: at 34 of 100 loads. Straight lines are
# drawn between them.
EVERY = 3


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


class Block:
    """The law under the block model, computed in a process that can be stopped."""

    def __init__(self, tasks: Tasks, changed: Callable[[], None]) -> None:
        self.tasks, self.changed = tasks, changed
        self.design: Design | None = None
        self.law: Other | None = None
        self.step = ""

    @property
    def running(self) -> bool:
        """Whether the law is being computed."""
        return self.tasks.running(SLOW)

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
        return self.law if self._is_of(design) else None

    def state(self, design: Design | None) -> dict[str, Any]:
        """Return whether the computation runs, its current step in words, and whether its law is shown."""
        words = f"The law under the block: {self.step} …" if self.running else ""
        return {"running": self.running, "step": words, "shown": self.of(design) is not None}

    def _is_of(self, design: Design | None) -> bool:
        """Return whether the law belongs to a design; after undo, an equal design is a different object."""
        return self.design is not None and (design is self.design or design == self.design)

    def _stepped(self, name: str, done: float | None) -> None:
        self.step = name if done is None else f"{name}, {percent(done)}"
        self.changed()
