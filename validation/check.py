"""Checks of computed numbers against expected ones, results without one, and claims made of them."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import partial
from typing import Any

import numpy as np

from metafem.drawing.inline import Drawn
from validation.sources import Source, known_input

# Sources of the misfit of designs, whose expected value is 0.
REQUIRED = known_input("target of the design, which counts as missed above 1 %")


@dataclass(frozen=True)
class Check:
    """A computed number, the expected one in words, and where the expected one comes from."""

    name: str
    computed: float
    expected: str
    passed: bool
    source: Source


@dataclass(frozen=True)
class Result:
    """A computed number that has no expected one, and the method that computed it."""

    name: str
    value: float
    method: str


class Reason(Enum):
    """Why a number or statement of the paper is not reproduced, in the words of the report."""

    CONTRADICTED = "Contradicted by other numbers of the paper"
    AMBIGUOUS = "Ambiguous: the paper does not print enough to decide"
    MISPRINTED = "Misprinted: the printed rule does not give the printed numbers"


@dataclass(frozen=True)
class Difference:
    """A statement of the paper that does not hold: computed number, printed text, and what holds in words."""

    name: str
    computed: float
    printed: str
    words: str
    source: Source
    reason: Reason = Reason.CONTRADICTED


@dataclass(frozen=True)
class Picture:
    """A figure that is made when it is drawn.

    Its caption, which says what to see, is the docstring of the function that draws it, with these values.
    """

    draw: Callable[[], Any]
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def caption(self) -> str:
        """The caption."""
        return prose(self.draw.func if isinstance(self.draw, partial) else self.draw, self.values)


Row = Check | Result | Difference


@dataclass(frozen=True)
class Claim:
    """What one file shows: checks, results, differences from the paper, and titled figures.

    Its text is the docstring of the function that returns it, with these values. What the report adds: its
    name, its file, the figures as they are drawn, and the seconds it took.
    """

    title: str
    rows: Sequence[Row]
    figures: Mapping[str, Picture] = field(default_factory=dict)
    values: Mapping[str, Any] = field(default_factory=dict)
    text: str = ""
    name: str = ""
    file: str = ""
    drawn: Sequence[Drawn] = ()
    seconds: float = 0.0

    @property
    def checks(self) -> list[Check]:
        """The rows with an expected number."""
        return [row for row in self.rows if isinstance(row, Check)]

    @property
    def failed(self) -> list[Check]:
        """The checks that failed."""
        return [check for check in self.checks if not check.passed]

    @property
    def results(self) -> list[Result]:
        """The rows without one."""
        return [row for row in self.rows if isinstance(row, Result)]

    @property
    def differences(self) -> list[Difference]:
        """The statements of the paper that do not hold."""
        return [row for row in self.rows if isinstance(row, Difference)]


def prose(function: Callable[..., Any], values: Mapping[str, Any]) -> str:
    """Return the paragraphs of a docstring, one a line, with values in place of their names in braces."""
    paragraphs = (inspect.getdoc(function) or "").split("\n\n")
    return "\n\n".join(" ".join(each.split()) for each in paragraphs).format(**values)


def near(name: str, computed: float, expected: float, tolerance: float, source: Source) -> Check:
    """Check that a number agrees with another within an absolute tolerance."""
    passed = bool(abs(computed - expected) <= tolerance)
    return Check(name, float(computed), f"{expected:.6g} ± {tolerance:.2g}", passed, source)


def below(name: str, computed: float, limit: float, source: Source) -> Check:
    """Check that a number, usually an error, does not exceed a limit."""
    return Check(name, float(computed), f"at most {limit:.3g}", bool(computed <= limit), source)


def above(name: str, computed: float, limit: float, source: Source) -> Check:
    """Check that a number is not less than a limit."""
    return Check(name, float(computed), f"at least {limit:.3g}", bool(computed >= limit), source)


def rms(values: np.ndarray) -> float:
    """Return the root of the mean square of numbers."""
    return float(np.sqrt((values**2).mean()))


def reported(name: str, value: float, method: str) -> Result:
    """Report a finite number that has no expected one."""
    if not math.isfinite(value):
        raise ValueError(f"{name}: {value} must be a finite number")
    return Result(name, float(value), method)
