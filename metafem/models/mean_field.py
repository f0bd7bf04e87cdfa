"""Mean field: the base sinks uniformly by the mean displacement."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import ClassVar

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput
from metafem.models.adhesion.curves import adhesive_law, independent_curve
from metafem.models.curve import Curve, RescaledState, Sensitivity, controlled
from metafem.models.independent import TOLERANCE, Independent
from metafem.models.model import Uncoupled
from metafem.notes import information
from metafem.surface import Surface

# Mean of 1/(pi r) over all pairs of points of a unit square: 4/pi [ln(1 + sqrt 2) - (sqrt 2 - 1)/3].
MEAN_DISPLACEMENT = 4.0 / math.pi * (math.log(1.0 + math.sqrt(2.0)) - (math.sqrt(2.0) - 1.0) / 3.0)

# Most Newton steps: where the load is convex the iterates decrease monotonically to the root, in far fewer.
MAX_STEPS = 200


@dataclass(frozen=True)
class MeanField(Uncoupled):
    """Independent asperities on a base that sinks by ``c p sqrt(A)/E*``, p = P/A the nominal pressure.

    ``c = 0.9464`` is the mean over a uniformly loaded square of area A, the nominal area of
    `nominal_area`. A uniform displacement changes only the separation; A0(P) is exactly that of
    `Independent`. Valid for a half-space and many asperities. Ciavarella, Greenwood and Paggi, Wear 265, 729
    (2008), doi:10.1016/j.wear.2008.01.019.

    Parameters
    ----------
    contact : Contact
        Law of one contact, any that `Independent` uses; default: `Hertz()`.

    Examples
    --------
    >>> from metafem import Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> alone, sunk = (equilibrium(surface, model, load=0.5) for model in (Independent(), MeanField()))
    >>> alone.area == sunk.area, round(alone.separation - sunk.separation, 4)
    (True, 0.029)
    """

    unloads: ClassVar[bool] = True

    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        _ = self._asperities  # checks the law

    def __repr__(self) -> str:
        """Return the constructor's call, without the default law."""
        return repr(self._asperities).replace("Independent", "MeanField", 1)

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``, with a law other than Hertz's."""
        return self._asperities.name.replace("independent", "mean-field", 1)

    @cached_property
    def _asperities(self) -> Independent:
        """The asperities on the base that sinks."""
        return Independent(self.contact)

    def curve(
        self,
        surface: Surface,
        load: FloatArray | None = None,
        *,
        approach: FloatArray | None = None,
        unloading: bool = False,
    ) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,).

        unloading: at these on the way back from the largest; loads of adhesive contacts may be negative.
        """
        values, by_load = controlled(load, approach)
        if by_load:
            return self._sunk(surface, self._asperities.curve(surface, values, unloading=unloading))
        adhesive = adhesive_law(self.contact, surface.material)
        if adhesive is not None:
            sinking = _compliance(surface)
            return independent_curve(self, adhesive, surface, values, by_load, unloading, sinking)
        local = self._asperities.curve(surface, approach=self._local(surface, values))
        sunk = self._sunk(surface, local)
        error = np.abs(sunk.approach - values) / np.where(local.approach > 0.0, local.approach, 1.0)
        return replace(sunk, approach=np.array(values), residual=error)

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads (k,), and dA0/dh at fixed load, that of `Independent`.

        height: summit heights (n,) [mm] in place of the surface's own; they are not checked.
        """
        found = self._asperities.sensitivity(surface, load, height)
        return replace(found, curve=self._sunk(surface, found.curve))

    def areas(
        self,
        surface: Surface,
        load: FloatArray,
        height: FloatArray,
        radius: FloatArray | None = None,
        position: FloatArray | None = None,
    ) -> FloatArray:
        """A0 [mm^2] at increasing rescaled loads (k,) for many surfaces, (m, k), that of `Independent`."""
        return self._asperities.areas(surface, load, height, radius)

    def _sunk(self, surface: Surface, curve: Curve) -> Curve:
        """Return the curve of independent asperities on the base that sinks."""
        compliance = _compliance(surface)
        return replace(
            curve,
            approach=curve.approach + compliance * curve.load,
            stiffness=curve.stiffness / (1.0 + compliance * curve.stiffness),
            compute_last=partial(self._last, surface, curve),
        )

    def _last(self, surface: Surface, curve: Curve) -> RescaledState:
        lone = information("one asperity has no neighbours: the mean field is zero")
        return replace(curve.last, model=self, notes=() if surface.count > 1 else (lone,))

    def _local(self, surface: Surface, approach: FloatArray) -> FloatArray:
        """Return the approaches y relative to the sunken base, y + compliance P(y) = approach.

        By Newton's method from above, which decreases to the root where P is convex; inside a bracket, as
        the load of contacts that yield is not convex.
        """
        compliance, gap = _compliance(surface), surface.gap
        law = self.contact.for_material(surface.material)
        most = float((gap + law.largest_indentation(surface.radius)).min())
        local = np.minimum(approach, most)
        low, high = np.minimum(0.0, approach), local
        for _ in range(MAX_STEPS):
            curve = self._asperities.curve(surface, approach=local)
            excess = local + compliance * curve.load - approach
            short = (local == most) & (excess < 0.0)
            if short.any():
                raise InvalidInput(
                    f"the approach {approach[short].max():.4g} mm needs more than {most:.4g} mm relative to "
                    f"the sunken base, up to which {law!r} describes all contacts; use smaller approaches or "
                    "a law with a larger range"
                )
            step = excess / (1.0 + compliance * curve.stiffness)
            low, high = np.where(excess < 0.0, local, low), np.where(excess > 0.0, local, high)
            far = (excess > 0.0) | (step < -TOLERANCE * np.abs(local))
            new = np.where(far, local - step, local)
            new = np.where((new >= low) & (new <= high), new, 0.5 * (low + high))
            if (new == local).all() or (np.abs(step) <= np.finfo(float).eps * np.abs(local)).all():
                return new
            local = new
        return local


def nominal_area(surface: Surface) -> float:
    """Return the nominal area A of the asperities [mm^2].

    The rectangle with n equal cells whose lattice has the second moments l1, l2 of the positions:
    ``A^2 = (12 l1 + A/n)(12 l2 + A/n)``. It is n times the square of the pitch on every rectangular
    piece of a square lattice, and does not depend on the axes. Infinite for one asperity.

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


def _compliance(surface: Surface) -> float:
    """Return the mean sinking per unit of P/E*, c/sqrt(A) [1/mm]."""
    return MEAN_DISPLACEMENT / math.sqrt(nominal_area(surface))
