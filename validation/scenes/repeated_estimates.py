"""Errors of estimates from many synthetic repetitions, beside their stated standard deviations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.bounded_interval import WIDTH


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
