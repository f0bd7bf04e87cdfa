"""Checks of computed numbers against expected ones, each with its source, and claims made of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from metafem.studies import Check

# Sources of bounds on the misfit of designs.
REQUIRED = "requirement of this check; design() reports a misfit above 1 % as a missed target"
LINE_REQUIRED = "10 %, above which design() reports a line with an intercept as a missed target"


def near(name: str, computed: float, expected: float, tolerance: float, source: str) -> Check:
    """Check that a number agrees with another within an absolute tolerance."""
    passed = bool(abs(computed - expected) <= tolerance)
    return Check(name, float(computed), f"{expected:.6g} ± {tolerance:.2g}", passed, source)


def below(name: str, computed: float, limit: float, source: str) -> Check:
    """Check that a number, usually an error, does not exceed a limit."""
    return Check(name, float(computed), f"at most {limit:.3g}", bool(computed <= limit), source)


def reported(name: str, computed: float, source: str) -> Check:
    """Report a finite number that has no published value to be compared with."""
    return Check(name, float(computed), "no published value", bool(np.isfinite(computed)), source)


@dataclass(frozen=True)
class Claim:
    """What one file shows: checks, at most three figures that are made when they are drawn, and a text."""

    title: str
    checks: list[Check]
    figures: dict[str, Callable[[], Any]] = field(default_factory=dict)
    text: str = ""
