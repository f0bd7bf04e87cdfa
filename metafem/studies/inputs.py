"""Random inputs with Gaussian errors, independent or correlated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import block_diag
from scipy.sparse.csgraph import connected_components
from scipy.stats import qmc

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if

# Standard deviations of inputs by name, or names and their covariance matrix.
Parameters = Mapping[str, ArrayLike] | tuple[Sequence[str], ArrayLike]

# Minimum distance of a positive input from zero, in standard deviations: the normal numbers of scipy's Sobol
# points are within 6.4.
WIDEST = 7.0

# Why an input is not available.
NEEDS = {
    "shear_strength": "needs a surface with a Friction",
    "area_ratio": "needs a surface with a Friction",
    "friction_force": "needs measured friction forces",
    "young_modulus": "is not an input; give composite_modulus = young_modulus/(1 - nu^2)",
}


@dataclass(frozen=True, eq=False)
class Inputs:
    """Random inputs: their names, standard deviations and correlations.

    Attributes
    ----------
    names : tuple of str, (p,)
    sd : tuple of ndarray, (p,)
        Standard deviation of each input, (1,), or (k,) if the input has k values.
    correlation : ndarray, (p, p)
    groups : list of list of int
        Indices of the inputs in each group; inputs of different groups are independent.
    """

    names: tuple[str, ...]
    sd: tuple[FloatArray, ...]
    correlation: FloatArray
    groups: list[list[int]]

    @classmethod
    def of(cls, parameters: Parameters, mean: Mapping[str, float | FloatArray]) -> Inputs:
        """Return the inputs; mean: nominal values of all available inputs.

        A number must stay positive under its errors. The values of an array may have any size, and one
        standard deviation for all values or one for each value.
        """
        given, covariance = parameters if isinstance(parameters, tuple) else (parameters, None)
        names = tuple(map(str, given))
        once = bool(names) and len(set(names)) == len(names)
        refuse_if(not once, f"parameters = {shown(parameters)} must name each of its parameters once")
        for name in names:
            why = NEEDS.get(name, f"is none of the parameters, {', '.join(mean)}")
            refuse_if(name not in mean, why, key=f"parameters.{name}")
        if isinstance(given, Mapping):
            sd = tuple(_deviation(name, value, mean[name]) for name, value in given.items())
            correlation = np.eye(len(names))
        else:
            deviations, correlation = _split(covariance, len(names))
            sd = tuple(deviations[:, None])
        for name, value in zip(names, sd, strict=True):
            most = np.inf if np.ndim(mean[name]) else float(mean[name]) / WIDEST
            words = f"must be at most {most:g}, a seventh of the value, which must not become negative"
            refuse_if(value[0] > most, words, key=f"parameters.{name}", value=float(value[0]))
        words = "parameters are all without errors; one standard deviation must be above 0"
        refuse_if(not any(value.any() for value in sd), words)
        count, label = connected_components(correlation != 0.0)
        groups = [np.flatnonzero(label == group).tolist() for group in range(count)]
        return cls(names, sd, correlation, groups)

    @property
    def labels(self) -> list[str]:
        """Names of the groups."""
        return [" + ".join(self.names[i] for i in group) for group in self.groups]

    def drawn(self, count: int, random: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Return two independent sets of correlated normal numbers, from Sobol points, (count, p)."""
        both = block_diag(self.correlation, self.correlation)
        normal = qmc.MultivariateNormalQMC(np.zeros(len(both)), both, rng=random).random(count)
        return normal[:, : len(self.names)], normal[:, len(self.names) :]

    def errors(self, normal: FloatArray) -> dict[str, FloatArray]:
        """Return the error of each input, (..., 1) or (..., k), for normal numbers (..., p)."""
        return {name: normal[..., [i]] * self.sd[i] for i, name in enumerate(self.names)}


def _deviation(name: str, value: Any, mean: float | FloatArray) -> FloatArray:
    """Return the standard deviation of an input, (1,), or one for each of its values, (k,)."""
    label = f"parameters.{name}"
    if np.ndim(mean) == 0 or check.scalar(value):
        return np.array([check.number(label, value, at_least=0.0)])
    return check.loads(label, check.array(label, value, shape=(np.size(mean),)))


def _split(covariance: Any, size: int) -> tuple[FloatArray, FloatArray]:
    """Return the standard deviations (p,) and correlations (p, p) of a covariance matrix."""
    matrix = check.array("covariance", covariance, shape=(size, size))
    sd = np.sqrt(np.abs(np.diag(matrix)))
    scale = np.where(sd > 0.0, sd, 1.0)
    correlation = matrix / scale / scale[:, None]
    try:
        qmc.MultivariateNormalQMC(np.zeros(size), correlation)
    except ValueError as error:
        words = f"must be symmetric and positive semidefinite: {error}"
        raise InvalidInput(words, key="covariance") from None
    return sd, correlation
