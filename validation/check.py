"""Checks of computed numbers against expected ones, each with its source, and claims made of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

# Sources of bounds on the misfit of designs.
REQUIRED = "requirement of this check; design() reports a misfit above 1 % as a missed target"
LINE_REQUIRED = "10 %, above which design() reports a line with an intercept as a missed target"


@dataclass(frozen=True)
class Check:
    """A computed number, the interval in which it must lie, and the source of that interval."""

    name: str
    computed: float
    expected: str
    passed: bool
    source: str

    def row(self) -> dict[str, Any]:
        """Return the check as plain data."""
        return {
            "name": self.name,
            "computed": float(self.computed),
            "expected": self.expected,
            "passed": bool(self.passed),
            "source": self.source,
        }


def near(name: str, computed: float, expected: float, tolerance: float, source: str) -> Check:
    """Check that a number agrees with another within an absolute tolerance."""
    passed = abs(computed - expected) <= tolerance
    return Check(name, computed, f"{expected:.6g} ± {tolerance:.2g}", passed, source)


def below(name: str, computed: float, limit: float, source: str) -> Check:
    """Check that a number, usually an error, does not exceed a limit."""
    return Check(name, computed, f"at most {limit:.3g}", computed <= limit, source)


def reported(name: str, computed: float, source: str) -> Check:
    """Report a finite number that has no published value to be compared with."""
    return Check(name, float(computed), "no published value", bool(np.isfinite(computed)), source)


def from_elements(checks: list[Any]) -> list[Check]:
    """Return the checks of `metafem.studies` in the form of this package."""
    return [Check(c.name, c.computed, c.expected, c.passed, c.source) for c in checks]


@dataclass(frozen=True)
class Claim:
    """What one file shows: checks, at most three figures that are made when they are drawn, and a text."""

    title: str
    checks: list[Check]
    figures: dict[str, Callable[[], Any]] = field(default_factory=dict)
    text: str = ""
