"""Mean-field interaction: the base sinks uniformly by the mean displacement under the nominal pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.models.curve import Curve
from metafem.models.independent import Uncoupled
from metafem.models.interacting.coupled import MEAN_PLANE
from metafem.notes import information
from metafem.surface import Surface

# Mean of 1/(pi r) over all pairs of points in a unit square: 4/pi [ln(1 + sqrt 2) - (sqrt 2 - 1)/3].
MEAN_DISPLACEMENT = 4.0 / math.pi * (math.log(1.0 + math.sqrt(2.0)) - (math.sqrt(2.0) - 1.0) / 3.0)

NO_NEIGHBOURS = information("one asperity has no neighbours: the mean field is zero")


@dataclass(frozen=True, repr=False)
class MeanField(Uncoupled):
    """Independent asperities on a base that sinks by ``c p sqrt(A)/E*`` under the nominal pressure p = P/A.

    The sinking is the mean displacement of a uniformly loaded square of area A, which gives ``c = 0.9464``.
    The nominal area A follows from the positions, see `nominal_area`. A uniform displacement changes only the
    separation, so A0(P) is that of `Independent`. The model is valid for a half-space and many asperities.
    With a periodic cell the separation is measured from the mean plane, so that the base does not sink.
    Ciavarella, Greenwood and Paggi, Wear 265, 729 (2008), doi:10.1016/j.wear.2008.01.019.

    Parameters
    ----------
    contact : Contact
        Law of one contact; `Independent` accepts the same laws. Default: `Hertz()`.

    Examples
    --------
    >>> from metafem import Independent, Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> alone, sunk = (equilibrium(surface, model, load=0.5) for model in (Independent(), MeanField()))
    >>> alone.area == sunk.area, round(alone.separation - sunk.separation, 4)
    (True, 0.029)
    """

    title: ClassVar[str] = "mean-field"

    contact: Contact = PARABOLOID

    def curve(
        self,
        surface: Surface,
        load: FloatArray | None = None,
        *,
        approach: FloatArray | None = None,
        unloading: bool = False,
    ) -> Curve:
        """Return equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,).

        unloading: whether the values are reached by unloading from the largest one. If the contacts adhere,
        loads may then be negative.
        """
        found = super().curve(surface, load, approach=approach, unloading=unloading)
        if surface.count > 1 and surface.cell is None:
            return found
        note = NO_NEIGHBOURS if surface.cell is None else MEAN_PLANE
        return replace(found, compute_last=lambda: replace(found.last, notes=(note,)))

    def compliance(self, surface: Surface) -> float:
        """Return the mean sinking per unit of P/E* [1/mm], c/sqrt(A)."""
        if surface.cell is not None:
            return 0.0
        return MEAN_DISPLACEMENT / math.sqrt(nominal_area(surface))


def nominal_area(surface: Surface) -> float:
    """Return the nominal area A of the asperities [mm^2].

    A is the area of a rectangular lattice of n cells whose sites have the same principal second moments l1
    and l2 as the positions: ``A^2 = (12 l1 + A/n)(12 l2 + A/n)``. For a rectangular piece of a square lattice
    it is n times the square of the pitch. It does not depend on the axes, and is infinite for one asperity.

    Examples
    --------
    >>> from metafem import Material
    >>> lattice = Surface.square_lattice(0.1, (8, 5), 1.5, radius=0.526, material=Material(1.36))
    >>> round(nominal_area(lattice), 9)
    90.0
    """
    n = surface.count
    if n == 1:
        return math.inf
    x, y = (surface.position - surface.position.mean(axis=0)).T
    xx, yy, xy = (12.0 * float(np.mean(product)) for product in (x * x, y * y, x * y))
    whole, product = (xx + yy) / n, max(xx * yy - xy * xy, 0.0)
    rest = 1.0 - 1.0 / n**2
    return (whole + math.sqrt(whole**2 + 4.0 * rest * product)) / (2.0 * rest)
