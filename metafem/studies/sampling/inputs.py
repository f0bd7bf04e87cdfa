"""Random inputs with Gaussian errors, independent or correlated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.special import ndtri

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.surface import Surface

# Minimum distance of a positive input from zero, in standard deviations. The smallest coordinate of a Sobol
# point with 30 bits is 2^-31; the inverse normal distribution there is -6.2.
WIDEST = 7.0

# Allowed rounding error of the correlations.
ROUNDING = 1e-9

# Conditions of the inputs that are not always available, and the remedy for a name that is not an input.
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
    root : ndarray, (p, p)
        Symmetric square root of the correlation matrix.
    groups : tuple of tuple of int
        Indices of the inputs in each group; inputs of different groups are independent.
    """

    names: tuple[str, ...]
    sd: tuple[FloatArray, ...]
    root: FloatArray
    groups: tuple[tuple[int, ...], ...]

    @staticmethod
    def of(parameters: Any, covariance: Any, mean: Mapping[str, float | FloatArray]) -> Inputs:
        """Return the inputs from standard deviations by name, or from names and their covariance matrix.

        mean: nominal values of all available inputs. A number must stay positive under its errors. The values
        of an array may have any size, and one standard deviation for all values or one for each value.
        """
        stated = f"parameters = {shown(parameters)}"
        refuse_if(
            isinstance(parameters, Mapping) != (covariance is None),
            f"{stated} must map names to standard deviations, or list the names of the rows of a covariance "
            "matrix",
        )
        names = tuple(map(str, parameters))
        once = names and len(set(names)) == len(names)
        refuse_if(not once, f"{stated} must name each of its parameters once")
        for name in names:
            refuse_if(name not in mean and name in NEEDS, f"parameters.{name} {NEEDS.get(name)}")
            words = f"parameters has no parameter {shown(name)}; there are {', '.join(mean)}"
            refuse_if(name not in mean, words)
        if isinstance(parameters, Mapping):
            sd = tuple(_deviation(name, value, mean[name]) for name, value in parameters.items())
            correlation = np.eye(len(names))
        else:
            deviations, correlation = _split(covariance, len(names))
            sd = tuple(deviations[:, None])
        for name, value in zip(names, sd, strict=True):
            key, most = f"parameters.{name}", float(np.min(mean[name])) / WIDEST
            words = "must be at most {.number}, a seventh of the value, which must not become negative"
            wide = np.ndim(mean[name]) == 0 and value[0] > most
            refuse_if(wide, words, Given(key, most), key=key, value=float(value[0]))
        words = "parameters are all without errors; one standard deviation must be above 0"
        refuse_if(not any(value.any() for value in sd), words)
        return Inputs(names, sd, _root(correlation), _groups(correlation))

    @property
    def labels(self) -> list[str]:
        """Names of the groups."""
        return [" + ".join(self.names[i] for i in group) for group in self.groups]

    def errors(self, unit: FloatArray) -> dict[str, FloatArray]:
        """Return the error of each input, (..., 1) or (..., k), at points of the unit cube (..., p)."""
        # no matrix product: its last bits would depend on the number of threads
        normal = np.einsum("...i,ji->...j", ndtri(unit), self.root)
        return {name: normal[..., [i]] * self.sd[i] for i, name in enumerate(self.names)}


def _deviation(name: str, value: Any, mean: float | FloatArray) -> FloatArray:
    """Return the standard deviation of an input, (1,), or one for each of its values, (k,)."""
    label = f"parameters.{name}"
    if np.ndim(mean) == 0 or check.scalar(value):
        return np.array([check.number(label, value, at_least=0.0)])
    each = check.array(label, value, shape=(np.size(mean),))
    lowest = Given(name, float(each.min()))
    refuse_if(each.min() < 0.0, "holds {.number}; it must be at least 0", lowest, key=label)
    return each


def _split(covariance: Any, size: int) -> tuple[FloatArray, FloatArray]:
    """Return the standard deviations (p,) and correlations (p, p) of a covariance matrix."""
    matrix = check.array("covariance", covariance, shape=(size, size))
    sd = np.sqrt(np.abs(np.diag(matrix)))
    scale = np.where(sd > 0.0, sd, 1.0)
    correlation = matrix / scale / scale[:, None]
    words = "covariance must be a symmetric matrix"
    refuse_if(np.abs(correlation - correlation.T).max() > ROUNDING, words)
    correlation = 0.5 * (correlation + correlation.T)
    smallest = float(np.linalg.eigvalsh(correlation)[0])
    words = "covariance must be positive semidefinite; the smallest eigenvalue of its correlations is"
    refuse_if(smallest < -ROUNDING, f"{words} {smallest:.3g}")
    return sd, correlation


def values_of(surface: Surface) -> dict[str, float | FloatArray]:
    """Return the nominal values of a surface's parameters that can have an error."""
    found: dict[str, float | FloatArray] = {
        "radius": float(surface.radius.mean()),
        "composite_modulus": surface.material.composite_modulus,
    }
    if surface.friction is not None:
        found |= {name: float(getattr(surface.friction, name)) for name in ("shear_strength", "area_ratio")}
    return found


def _root(correlation: FloatArray) -> FloatArray:
    value, vector = np.linalg.eigh(correlation)
    return np.asarray((vector * np.sqrt(np.maximum(value, 0.0))) @ vector.T)


def _groups(correlation: FloatArray) -> tuple[tuple[int, ...], ...]:
    """Return the groups of inputs that are correlated with each other, directly or through others."""
    _, label = connected_components(correlation != 0.0)
    return tuple(tuple(np.flatnonzero(label == group).tolist()) for group in range(label.max() + 1))
