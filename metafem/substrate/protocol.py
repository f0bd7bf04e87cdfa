"""The protocol of elastic substrates."""

from __future__ import annotations

from typing import Protocol, TypeVar, runtime_checkable

from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.surface import Surface

T = TypeVar("T")


def agreed(substrate: str, name: str, stated: T | None, given: T | None) -> T | None:
    """Return a value that the substrate or the surface defines; raise InvalidInput if both do and differ."""
    refuse_if(
        stated is not None and given is not None and stated != given,
        f"{substrate} has {name} = {stated}, but the surface has {given}",
    )
    return given if stated is None else stated


@runtime_checkable
class Substrate(Protocol):
    """Green's function of the block: the surface displacement per unit of rescaled load P/E*."""

    def for_surface(self, surface: Surface) -> Substrate:
        """Return the substrate with the dimensions and the Poisson's ratio of a surface."""
        ...

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Return the displacement at asperity i per unit of rescaled load on asperity j, (n, n) [1/mm].

        The diagonal contains the regular self terms: the difference from a half-space at r = 0.
        """
        ...

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return derivatives of the displacement at asperity i per unit of rescaled load on j, each (n, n).

        They are the two components of the in-plane gradient at i [1/mm^2] and the in-plane Laplacian
        [1/mm^3]. The diagonals contain the regular self terms.
        """
        ...
