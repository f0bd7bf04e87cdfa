"""Random inputs with Gaussian errors, independent or correlated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.special import ndtri

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem.errors import InvalidInput

# A positive input is at least this number of standard deviations above zero: a coordinate of a Sobol point of
# 30 bits is at least 2^-31, and the inverse normal distribution there is -6.2.
WIDEST = 7.0

# Rounding of a covariance matrix, in units of the standard deviations.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Inputs:
    """Names (p,) of inputs and their errors.

    Attributes
    ----------
    names : tuple of str, (p,)
    sd : tuple of ndarray, (p,)
        Standard deviation of each, (1,), or (k,) if the input has k values.
    root : ndarray, (p, p)
        Symmetric square root of the matrix of correlations.
    groups : tuple of tuple of int
        Inputs that are correlated with each other.
    """

    names: tuple[str, ...]
    sd: tuple[FloatArray, ...]
    root: FloatArray
    groups: tuple[tuple[int, ...], ...]

    @staticmethod
    def of(
        parameters: Any,
        covariance: Any,
        mean: Mapping[str, float | FloatArray],
        missing: Mapping[str, str] = MappingProxyType({}),
    ) -> Inputs:
        """Return the inputs from standard deviations by name, or from names and their covariance matrix.

        mean: the values of all inputs that can be named; an array has values of any size, each with a common
        or its own deviation, and a number is positive. missing: the requirement of the other inputs.
        """
        given = isinstance(parameters, Mapping)
        if given != (covariance is None):
            raise InvalidInput(
                f"parameters = {shown(parameters)} must map names to standard deviations, or list the names "
                "of the rows of a covariance matrix"
            )
        if isinstance(parameters, str) or not isinstance(parameters, (Mapping, Sequence)):
            raise InvalidInput(f"parameters = {shown(parameters)} must be a list of names")
        names = tuple(map(str, parameters))
        known = ", ".join(mean)
        if not names or len(set(names)) < len(names):
            raise InvalidInput(f"parameters = {shown(parameters)} must name each of its parameters once")
        for name in names:
            if name == "young_modulus":
                raise InvalidInput(
                    f"parameters.{name} is not an input; give composite_modulus = {name}/(1 - nu^2)"
                )
            if name in missing:
                raise InvalidInput(f"parameters.{name} needs {missing[name]}")
            if name not in mean:
                raise InvalidInput(f"parameters has no parameter {shown(name)}; there are {known}")
        if isinstance(parameters, Mapping):
            sd = tuple(_deviation(name, value, mean[name]) for name, value in parameters.items())
            correlation = np.eye(len(names))
        else:
            deviations, correlation = _split(covariance, len(names))
            sd = tuple(np.array([value]) for value in deviations)
        for name, value in zip(names, sd, strict=True):
            most = np.min(mean[name]) / WIDEST
            if np.ndim(mean[name]) == 0 and value[0] > most:
                member = f"parameters.{name}"
                words = "must be at most {.number}, a seventh of the value, which must not become negative"
                raise InvalidInput(words, Given(member, most), key=member, value=value[0])
        if not any(value.any() for value in sd):
            raise InvalidInput("parameters are all without errors; one standard deviation must be above 0")
        return Inputs(names, sd, _root(correlation), _groups(correlation))

    @property
    def labels(self) -> list[str]:
        """Names of the groups."""
        return [" + ".join(self.names[i] for i in group) for group in self.groups]

    def errors(self, unit: FloatArray) -> dict[str, FloatArray]:
        """Return the error of each input, (..., 1) or (..., k), at points of the unit cube (..., p)."""
        # no product of matrices: its last bits depend on the number of threads
        normal = np.einsum("...i,ji->...j", ndtri(unit), self.root)
        return {name: normal[..., [i]] * self.sd[i] for i, name in enumerate(self.names)}


def _deviation(name: str, value: Any, mean: float | FloatArray) -> FloatArray:
    """Return a standard deviation (1,), or those of each value of an input (k,)."""
    label = f"parameters.{name}"
    if np.ndim(mean) == 0 or check.scalar(value):
        return np.array([check.number(label, value, at_least=0.0)])
    each = check.array(label, value, shape=(np.size(mean),))
    if each.min() < 0.0:
        lowest = Given(name, each.min())
        raise InvalidInput("holds {.number}; it must be at least 0", lowest, key=label)
    return each


def _split(covariance: Any, size: int) -> tuple[FloatArray, FloatArray]:
    """Return the standard deviations (p,) and correlations (p, p) of a covariance matrix."""
    matrix = check.array("covariance", covariance, shape=(size, size))
    variance = np.diag(matrix)
    if variance.min() < 0.0:
        i = int(variance.argmin())
        raise InvalidInput(f"covariance[{i}][{i}] = {variance[i]:g} must be at least 0")
    sd = np.sqrt(variance)
    scale = np.where(sd > 0.0, sd, 1.0)
    correlation = matrix / scale / scale[:, None]
    off = np.argwhere(np.abs(correlation - correlation.T) > ROUNDING)
    if off.size:
        i, j = off[0].tolist()
        raise InvalidInput(
            f"covariance[{i}][{j}] = {matrix[i, j]:g} and covariance[{j}][{i}] = {matrix[j, i]:g} differ; "
            "the matrix must be symmetric"
        )
    correlation = 0.5 * (correlation + correlation.T)
    smallest = float(np.linalg.eigvalsh(correlation)[0])
    if smallest < -ROUNDING:
        raise InvalidInput(
            "covariance must be positive semidefinite; the smallest eigenvalue of its correlations is "
            f"{smallest:.3g}"
        )
    return sd, correlation


def _root(correlation: FloatArray) -> FloatArray:
    value, vector = np.linalg.eigh(correlation)
    return np.asarray((vector * np.sqrt(np.maximum(value, 0.0))) @ vector.T)


def _groups(correlation: FloatArray) -> tuple[tuple[int, ...], ...]:
    """Return the inputs that are correlated, directly or through others."""
    linked = correlation != 0.0
    np.fill_diagonal(linked, True)
    for _ in range(len(linked)):
        linked = (linked[:, :, None] & linked[None, :, :]).any(axis=1)
    # each input belongs to the group of the first input that it is linked with
    first = linked.argmax(axis=1).tolist()
    return tuple(tuple(i for i, k in enumerate(first) if k == group) for group in dict.fromkeys(first))
