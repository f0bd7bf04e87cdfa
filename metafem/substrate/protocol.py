"""The protocol of elastic substrates."""

from __future__ import annotations

from typing import Protocol, TypeVar, runtime_checkable

from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.surface import Surface

T = TypeVar("T")


def agreed(substrate: str, name: str, stated: T | None, given: T | None) -> T | None:
    """Return a value defined by the substrate or by the surface; if by both, the two must be equal."""
    refuse_if(
        stated is not None and given is not None and stated != given,
        f"{substrate} has {name} = {stated}, but the surface has {given}",
    )
    return given if stated is None else stated


@runtime_checkable
class Substrate(Protocol):
    """Green's function of the block: surface displacement per unit of rescaled load P/E*."""

    def for_surface(self, surface: Surface) -> Substrate:
        """Return the substrate with the dimensions and the Poisson's ratio of a surface."""
        ...

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Displacement at each asperity per load on every other one, (n, n) [1/mm].

        The diagonal holds the regular self terms: the difference from a half-space at r = 0.
        """
        ...

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of the displacement at asperity i per load on j, each (n, n).

        The two components of its in-plane gradient at i [1/mm^2] and its in-plane Laplacian
        [1/mm^3]; diagonals hold the regular self terms.
        """
        ...
