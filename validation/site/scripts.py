"""The scripts of `validation/examples/`, and what they print and draw when they are run."""

from __future__ import annotations

import ast
import io
import re
import runpy
from contextlib import redirect_stdout
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from typing import Any, NamedTuple

FOLDER = Path(__file__).parents[1] / "examples"


@dataclass(frozen=True)
class Script:
    """An example: one file whose docstring says in its first line what it shows, and then what one learns."""

    path: Path

    @property
    def name(self) -> str:
        """Name of the file without its ending, which names the page."""
        return self.path.stem

    @property
    def source(self) -> str:
        """The whole text of the file."""
        return self.path.read_text("utf-8")

    @property
    def docstring(self) -> str:
        """The docstring of the file."""
        return ast.get_docstring(ast.parse(self.source)) or ""

    @property
    def title(self) -> str:
        """First line of the docstring."""
        return self.docstring.partition("\n")[0].removesuffix(".")

    @property
    def text(self) -> str:
        """The docstring below its first line."""
        return self.docstring.partition("\n\n")[2]

    @property
    def lesson(self) -> str:
        """The sentence of the docstring that says what one learns."""
        sentences = re.split(r"(?<=\.) (?=[A-Z])", " ".join(self.text.split()))
        return next(each for each in sentences if each.startswith("You learn"))

    @property
    def code(self) -> str:
        """The file without its docstring."""
        documentation = ast.parse(self.source).body[0]
        return "\n".join(self.source.splitlines()[documentation.end_lineno :]).strip() + "\n"

    @property
    def caption(self) -> str:
        """The comment above the line that names the figure."""
        above = self.source.partition("\nfigure = ")[0].splitlines()
        lines = takewhile(lambda line: line.startswith("# "), reversed(above))
        return " ".join(line.removeprefix("# ") for line in reversed(list(lines)))


class Run(NamedTuple):
    """What a script printed and drew."""

    output: str
    figure: Any


def scripts() -> list[Script]:
    """Return the examples in the order of their numbers."""
    return [Script(path) for path in sorted(FOLDER.glob("e[0-9]*.py"))]


def run(script: Script) -> Run:
    """Run a script in this process, without a window for its figure."""
    from matplotlib import pyplot

    pyplot.switch_backend("agg")
    printed = io.StringIO()
    try:
        with redirect_stdout(printed):
            names = runpy.run_path(str(script.path))
        return Run(printed.getvalue(), names["figure"])
    finally:
        pyplot.close("all")
