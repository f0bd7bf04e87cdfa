"""One number against another: what a claim is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Check:
    """A computed number, the interval in which it must lie, and where that comes from."""

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
    """Check that a number, an error mostly, does not exceed a limit."""
    return Check(name, computed, f"at most {limit:.3g}", computed <= limit, source)


def from_elements(checks: list[Any]) -> list[Check]:
    """Return the finite elements' own checks in the form of the page."""
    return [Check(c.name, c.computed, c.expectation, c.passed, c.source) for c in checks]


@dataclass(frozen=True)
class Claim:
    """What one file shows: its checks, at most three figures made only when they are drawn, and words."""

    title: str
    checks: list[Check]
    figures: dict[str, Callable[[], Any]] = field(default_factory=dict)
    text: str = ""
