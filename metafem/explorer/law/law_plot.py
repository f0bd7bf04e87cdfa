"""The plot of the law, on which the user drags points."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import json
from nicegui.element import Element


class LawPlot(Element, component="law_plot.js", esm={"metafem-law": "js"}):
    """Draws the data of `law_data`, and emits an event for each action of the pointer or the keyboard.

    Each keyword argument is the handler of the event with its name.
    """

    def __init__(self, **handlers: Callable[[Any], Any]) -> None:
        super().__init__()
        for name, handler in handlers.items():
            self.on(name, lambda event, handler=handler: handler(event.args))

    def draw(self, data: dict[str, Any]) -> None:
        """Draw the data of an answer."""
        # the browser parses a statement once, but the data of a `run_method` call twice
        self.client.run_javascript(f'runMethod({self.id}, "draw", [{json.dumps(data)}])')

    def more(self, data: dict[str, Any]) -> None:
        """Draw the data of `Beside`: the tolerance band and the laws under further models."""
        self.run_method("more", data)

    def refuse(self, request: int, words: str) -> None:
        """Show why a request of the plot changed nothing."""
        self.run_method("refuse", request, words)

    def say(self, words: str, *, wrong: bool = False) -> None:
        """Show a message below the plot, as an error if `wrong`."""
        self.run_method("say", words, wrong)
