"""The plot of the law, whose points are dragged in the browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui.element import Element


class LawPlot(Element, component="law_plot.js"):
    """Draws the data of `law_data` and emits ``drag``, ``add``, ``remove``, ``cursor`` and ``dropped``."""

    def on_event(self, name: str, handler: Callable[[Any], None]) -> None:
        """Call a function with the data of an event."""
        self.on(name, lambda event: handler(event.args))

    def show(self, data: dict[str, Any]) -> None:
        """Draw the data of an answer."""
        self.run_method("show", data)
