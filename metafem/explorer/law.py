"""The panel of the law: it makes edits of what the user does, and draws answers and curves beside them."""

from __future__ import annotations

import math
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

from metafem._values import MICROMETRES
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.certainty import tolerance_band
from metafem.explorer.control import Control, Panel
from metafem.explorer.handles import RESOLUTION, moved, removed, scene_of
from metafem.explorer.history import State
from metafem.explorer.kinds import reachable, with_nearest, with_point
from metafem.explorer.law_data import Units, law_data, measured_data, numbers, pinned_data
from metafem.explorer.queue import Queue
from metafem.explorer.scene import Scene
from metafem.explorer.table import Table

Event = dict[str, Any]

# The smallest part of its axes that a plot shows, as `law_plot.js` has it.
LEAST_PART = 1e-3


def beside(answer: Answer) -> dict[str, Any]:
    """Return the tolerance band of an answer, which takes longer than its law."""
    band, design = tolerance_band(answer), answer.design
    if band is None or design is None:
        return {"number": answer.number, "tolerance": None}
    units = Units.of_design(answer, answer.state.newtons)
    load, low, high = band
    micrometres = MICROMETRES * (design.limits.height_sd or 0.0)
    tolerance = {
        "x": numbers(units.load * load),
        "low": numbers(units.friction * low),
        "high": numbers(units.friction * high),
        "name": f"mean ± 1 SD of made surfaces, with errors of the heights of {micrometres:.3g} µm (SD)",
    }
    return {"number": answer.number, "tolerance": tolerance}


class LawPanel(Panel, component="static/law_plot.js"):
    """The plot of the law, which draws the data of `law_data` and `beside`."""

    def __init__(self, page: Control) -> None:
        names = [name for name in dir(type(self)) if name.startswith("on_")]
        super().__init__(page, **{name[3:]: partial(self._handle, getattr(self, name)) for name in names})
        self.band: Queue[Answer, dict[str, Any]] = Queue(
            beside, partial(self.call, "more"), lambda _, error: page.wrong(error)
        )
        # number of the plot for each change of the page by a drag, and for the newest one that is answered
        self.requests: dict[int, int] = {}
        self.request = 0
        self.base: Scene | None = None  # the target of the current state, where every step of a drag starts
        self.refused: Answer | None = None
        self.pinned: Answer | None = None
        self.stuck = False  # whether the state from which a drag starts is refused

    def prepare(self, answer: Answer) -> dict[str, Any]:
        """Return the data of an answer that the plot draws."""
        data = law_data(answer)
        units = Units.of(answer.template, answer.state.newtons)
        data |= {"pinned": pinned_data(self.pinned, units), "measured": None}
        try:
            data["measured"] = measured_data(answer)
        except InvalidInput as error:
            data["problem"] = str(error)
        return data

    def show(self, answer: Answer, data: dict[str, Any]) -> None:
        """Draw an answer."""
        for number in [each for each in self.requests if each <= answer.number]:
            self.request = self.requests.pop(number)
        base = data.pop("base")
        if base is not None and answer.state.text == self.page.state.text:
            self.base = base
            self.stuck = answer.refusal != "" and not answer.undecided
        if answer.nearest_target is not None:
            self.refused = answer
        self.call("draw", data | {"request": self.request})
        if "problem" in data:
            self.say(data["problem"], wrong=True)
        if answer.design is not None:
            self.band.put(answer)

    def say(self, words: str, *, wrong: bool = False) -> None:
        """Show a message below the plot, as an error if `wrong`."""
        self.call("say", words, wrong)

    async def _handle(self, handler: Callable[[Event], Awaitable[None]], event: Event) -> None:
        """Handle an event; an InvalidInput error is shown below the plot."""
        await self.page.told(handler(event), lambda words: self.say(words, wrong=True))

    async def on_drag(self, event: Event) -> None:
        """Move a handle."""
        number, id, place = int(event["number"]), event["id"], self._place(event)
        # a zoomed plot resolves smaller parts of a value
        resolution = RESOLUTION * min(1.0, max(LEAST_PART, float(event.get("part", 1.0))))

        def dragged(state: State) -> Table:
            if not event.get("back"):
                return moved(self._base(state), id, *place, resolution)
            answer = self.page.answer
            return reachable(answer) if self.stuck and answer.refusal else state.table

        self.requests[self.page.asked + 1] = number
        try:
            await self.page.make(dragged, draft=not event["released"])
        except InvalidInput as error:
            self.call("refuse", number, str(error))

    async def on_add(self, event: Event) -> None:
        """Add a point; close to the achieved law it is on this law."""
        place, near = self._place(event), self._units().rescaled(0.0, float(event.get("near", 0.0)))[1]

        def drawn(state: State) -> Table:
            base = self._base(state)
            return with_point(Answer(self.page.number, state, base.specification, base.design), *place, near)

        await self.page.make(drawn)

    async def on_remove(self, event: Event) -> None:
        """Remove a point."""
        await self.page.make(lambda state: removed(self._base(state), event["id"]))

    async def on_cursor(self, event: Event) -> None:
        """Show the contacts at another load."""
        units = Units.of_design(self.page.answer, self.page.state.newtons)
        load, _ = units.rescaled(float(event["x"]), 0.0)
        if math.isfinite(load) and load > 0.0:
            await self.page.alter(load=load)

    async def on_nearest(self, event: Event) -> None:
        """Set the nearest law of the last refusal as the target."""
        refused = self.refused
        if refused is not None:
            await self.page.make(lambda state: with_nearest(refused))

    async def on_axes(self, event: Event) -> None:
        """Show newtons or rescaled values."""
        await self.page.alter(newtons=bool(event["newtons"]))

    async def on_pin(self, event: Event) -> None:
        """Keep the law that is shown on the plot, or remove the one that is kept."""
        self.pinned = self.page.answer if event["on"] else None
        await self.page.renew(self)

    async def on_measured(self, event: Event) -> None:
        """Remove the measured points."""
        await self.page.alter(measured="", measured_name="")

    def _units(self) -> Units:
        return Units.of(self.page.answer.template, self.page.state.newtons)

    def _place(self, event: Event) -> tuple[float, float]:
        return self._units().rescaled(float(event["x"]), float(event["y"]))

    def _base(self, state: State) -> Scene:
        """Return the target of a state, from which a drag starts."""
        base = self.base
        if base is None or base.state.text != state.text:
            self.base = base = scene_of(state, specification_of(state), self.page.answer.design)
        return base
