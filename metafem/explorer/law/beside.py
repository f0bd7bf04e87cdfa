"""Curves that are added to the plot after the law: the tolerance band and the laws under further models."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from metafem.explorer.answer import Answer, pinned_answer
from metafem.explorer.certainty.background import Tasks
from metafem.explorer.certainty.band import Band, band_words, tolerance_band
from metafem.explorer.law.law_data import band_data
from metafem.explorer.law.others import QUICK, Block, Other, other_law, own_name
from metafem.explorer.law.shown import Units
from metafem.explorer.law.tools import block_data
from metafem.explorer.queue import Queue, in_words
from metafem.inversion import Design

# An answer, its tolerance band, a description of the band, the laws under further models, and the answer
# that is pinned.
More = tuple[Answer, Band | None, str, tuple[Other, ...], Answer | None]


class Beside:
    """Computes in a thread the additional curves of the newest answer, and passes them to the plot."""

    def __init__(self, tasks: Tasks, draw: Callable[[dict[str, Any]], None]) -> None:
        self.draw = draw
        self.newest: Queue[Answer, More] = Queue(self._computed, self._show, self._failed)
        self.block = Block(tasks, self._renew)
        self.design: Design | None = None
        self.laws: dict[str, Other] = {}
        self.last: More | None = None

    def put(self, answer: Answer) -> None:
        """Compute the additional curves of an answer, unless a newer answer replaces it."""
        if answer.design is not None:
            self.newest.put(answer)

    def _computed(self, answer: Answer) -> More:
        """Return the additional curves of an answer; laws already computed for the same design are reused."""
        design = answer.design
        assert design is not None
        laws = self.laws if design is self.design else {}
        wanted = [name for name in QUICK if name in answer.state.models]
        names = [name for name in wanted if name != own_name(design)] if wanted else []
        laws = {name: laws.get(name) or other_law(design, name) for name in names}
        self.design, self.laws = design, laws
        pinned = pinned_answer(answer.state.pinned)
        return answer, tolerance_band(answer), band_words(answer), tuple(laws.values()), pinned

    def _show(self, more: More) -> None:
        self.last = more
        self._renew()

    def _failed(self, answer: Answer, error: Exception) -> None:
        """Show the error, and no additional curves of the answer."""
        self._show((answer, None, "", (Other("", error=in_words(error)),), None))

    def _renew(self) -> None:
        """Draw the curves that are known."""
        if self.last is None:
            return
        answer, band, words, laws, pinned = self.last
        units = Units.of_design(answer, answer.state.newtons)
        block = self.block.of(answer.design)
        found = [*laws, *([] if block is None else [block])]
        self.draw(
            {
                "number": answer.number,
                "tolerance": None if band is None else band_data(band, units) | {"name": words},
                "others": [
                    units.curve(each.load, each.friction) | {"name": each.words}
                    for each in found
                    if not each.error
                ],
                "pinned": None if pinned is None else _curve(pinned, units),
                "errors": [each.error for each in found if each.error],
                "block": block_data(self.block, answer.design),
            }
        )


def _curve(pinned: Answer, units: Units) -> dict[str, Any] | None:
    """Return the law of a pinned answer in the units of the axes; None if it has no forces for newtons."""
    own = Units.of_design(pinned, units.newtons)
    if pinned.design is None or own.newtons != units.newtons:
        return None
    return own.curve(pinned.design.law.rescaled_load, pinned.design.law.rescaled_friction)
