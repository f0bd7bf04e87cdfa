"""Errors of estimates from many synthetic repetitions: bias and coverage, their sources and a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.statistics import WIDTH
from validation.check import Check, below, near
from validation.sources import known_input

# A bias of a fifth of the standard deviation changes the coverage of 68 % intervals by less than 1 %.
TRUTH = known_input("true values of the synthetic data; a bias of a fifth of the uncertainty is allowed")
COVERED = known_input("nominal 68 % of the intervals; 66 to 70 % is allowed")

# Coverage that the intervals state, and how far it may be off: three standard errors of 5,000 trials.
NOMINAL, ALLOWED = 0.68, 0.02


class Errors(NamedTuple):
    """Errors of an estimate and its stated standard deviations, (trials,)."""

    error: FloatArray
    sd: FloatArray

    @property
    def bias(self) -> float:
        """Mean error over the mean stated standard deviation."""
        return float(self.error.mean() / self.sd.mean())

    @property
    def coverage(self) -> float:
        """Share of 68 % intervals that hold the true value."""
        return float((np.abs(self.error) <= WIDTH * self.sd).mean())


def judged(case: str, name: str, errors: Errors) -> Iterator[Check]:
    """Check the bias and the coverage of an estimate."""
    yield below(f"{case}: bias of {name} over its uncertainty", abs(errors.bias), 0.2, TRUTH)
    what = f"{case}: 68 % intervals of {name} that hold it"
    yield near(what, errors.coverage, NOMINAL, ALLOWED, COVERED)


def histograms(axes: Sequence[Any], found: Sequence[Mapping[str, Errors]], edges: FloatArray) -> None:
    """Draw errors over their stated standard deviations, and the distribution that is stated."""
    x = np.linspace(edges[0], edges[-1], 400)
    for ax, estimates in zip(axes, found, strict=True):
        for name, each in estimates.items():
            score = np.clip(each.error / each.sd, edges[0], edges[-1])
            ax.hist(score, edges, density=True, histtype="step", lw=1.4, label=name)
        ax.plot(x, np.exp(-0.5 * x**2) / np.sqrt(2.0 * np.pi), color="black", lw=0.9, label="as stated")
        ax.set_xlabel("error over the stated uncertainty")
        ax.legend(frameon=False, fontsize="small")
    axes[0].set_ylabel("density")
