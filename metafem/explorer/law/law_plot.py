"""The plot of the law, whose points are dragged in the browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import json
from nicegui.element import Element


class LawPlot(Element, component="law_plot.js", esm={"metafem-law": "js"}):
    """Draws the data of `law_data`, and emits what hands and keys do.

    Each event has a handler of its name.
    """

    def __init__(self, **handlers: Callable[[Any], Any]) -> None:
        super().__init__()
        for name, handler in handlers.items():
            self.on(name, lambda event, handler=handler: handler(event.args))

    def draw(self, data: dict[str, Any]) -> None:
        """Draw the data of an answer."""
        # sent as a statement: `run_method` sends a value to be returned, which the browser parses twice
        self.client.run_javascript(f'runMethod({self.id}, "draw", [{json.dumps(data)}])')

    def more(self, data: dict[str, Any]) -> None:
        """Draw what belongs beside an answer."""
        self.run_method("more", data)

    def refuse(self, request: int, words: str) -> None:
        """Tell why a request of the plot changed nothing."""
        self.run_method("refuse", request, words)

    def say(self, words: str, *, wrong: bool = False) -> None:
        """Say something below the plot."""
        self.run_method("say", words, wrong)
