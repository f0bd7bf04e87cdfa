"""Curves of equilibria, the result of every model. All loads are rescaled, P/E* [mm^2]."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.errors import InvalidInput, NotConverged
from metafem.notes import Note
from metafem.surface import Surface

# Names of the arrays of a curve, each with one entry per equilibrium.
ARRAYS = ("approach", "load", "area", "stiffness", "residual", "tolerance")


class Status(Enum):
    """Whether a solution converged; the value of a member is its message."""

    CONVERGED = "converged: the residual is within the model's tolerance"
    NOT_CONVERGED = "not converged: the residual exceeds the model's tolerance"


class ModelError(float):
    """Estimated relative error of A0(P) of a model: a number, with the estimate that it is based on.

    The error is the largest along a curve, compared with resolved contacts on the same substrate. It is nan
    if it cannot be estimated.

    Attributes
    ----------
    source : str
        Model or quantity from which the error was estimated; if the error is nan, the reason.
    load : ndarray, (m,)
        Rescaled loads [mm^2] at which the model was compared with the source; empty if the source is not a
        model.
    change : ndarray, (m,)
        Relative difference of A0 of the source from A0 of the model, at these loads.
    solved : bool
        Whether the source has a solution at all loads at which it was compared.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (4, 4), radius=0.526, material=mf.Material(1.36))
    >>> error = mf.equilibrium(surface, mf.Interacting(1), load=0.2).model_error
    >>> round(error, 4), error.source
    (0.0007, 'order 3 on the half-space')
    """

    source: str
    load: FloatArray
    change: FloatArray
    solved: bool

    def __new__(
        cls, value: float, source: str = "", load: Any = (), change: Any = (), solved: bool = True
    ) -> Self:
        """Return the number `value` with its attributes."""
        error = super().__new__(cls, value)
        error.source, error.solved = source, solved
        error.load, error.change = np.asarray(load, dtype=float), np.asarray(change, dtype=float)
        return error


@dataclass(frozen=True, eq=False)
class RescaledState:
    """Loads, areas and indentations of the asperities in one equilibrium."""

    load: FloatArray  # (n,), rescaled load of each asperity, P_i/E* [mm^2]
    area: FloatArray  # (n,), contact area of each asperity [mm^2]
    indentation: FloatArray  # (n,), indentation of each asperity [mm]; minus the gap if it is open
    # smallest distance between the rigid plane and the base near a summit [mm], see `ContactState`
    base_gap: float
    model: Any  # the model that was solved
    notes: tuple[Note, ...] = ()  # approximations of this state
    field: Any = None  # `ContactField` or None; the pressure is divided by E* [-]


def solved(
    residual: FloatArray, tolerance: FloatArray | float, load: FloatArray, area: FloatArray
) -> np.ndarray:
    """Return whether equilibria are converged and finite, for arrays of any shape."""
    return np.asarray((residual <= tolerance) & np.isfinite(load + area))


@dataclass(frozen=True, eq=False)
class Curve:
    """Equilibria of one surface along increasing loads or approaches, all arrays (k,).

    Attributes
    ----------
    approach : ndarray
        Tallest summit minus separation [mm].
    load : ndarray
        Rescaled load P/E* [mm^2], recomputed at the approach.
    area : ndarray
        Real contact area A0 [mm^2].
    stiffness : ndarray
        Derivative of the rescaled load with respect to the approach [mm].
    residual : ndarray
        Largest relative error of the equations [-], recomputed for the returned solution.
    tolerance : float or ndarray
        Largest residual of a converged equilibrium, for all or for each.
    compute_last : callable
        Function that returns the last state; it is called when `last` is first read.
    notes : tuple of Note
        Approximations that concern the complete curve.
    error : ModelError, optional
        Estimated error of the model, if the model estimates it while it solves.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> curve = mf.Independent().curve(surface, np.array([0.01, 0.02]))
    >>> curve.area.round(4), curve.converged, curve.last.load.round(4)
    (array([0.096 , 0.1551]), True, array([0.0069, 0.0131]))
    """

    approach: FloatArray
    load: FloatArray
    area: FloatArray
    stiffness: FloatArray
    residual: FloatArray
    tolerance: FloatArray | float
    compute_last: Callable[[], RescaledState]
    notes: tuple[Note, ...] = ()
    error: ModelError | None = None

    def part(self, rows: IntArray, compute_last: Callable[[], RescaledState]) -> Curve:
        """Return the curve at some of its rows; `compute_last` is used if they end before the last one."""
        whole = rows[-1] == len(self.load) - 1
        arrays: dict[str, Any] = {name: self._array(name)[rows] for name in ARRAYS}
        return replace(self, **arrays, compute_last=(lambda: self.last) if whole else compute_last)

    @staticmethod
    def joined(parts: list[Curve]) -> Curve:
        """Return one curve that consists of consecutive parts."""
        arrays: dict[str, Any] = {
            name: np.concatenate([part._array(name) for part in parts]) for name in ARRAYS
        }
        return replace(
            parts[-1],
            **arrays,
            notes=tuple(dict.fromkeys(note for part in parts for note in part.notes)),
            error=_largest([part.error for part in parts]),
        )

    def _array(self, name: str) -> FloatArray:
        """Return one of `ARRAYS`, (k,)."""
        return np.broadcast_to(getattr(self, name), self.load.shape)

    @cached_property
    def last(self) -> RescaledState:
        """State of the asperities in the last equilibrium."""
        return self.compute_last()

    @cached_property
    def solved(self) -> np.ndarray:
        """Whether each equilibrium is converged and finite, (k,)."""
        return solved(self.residual, self.tolerance, self.load, self.area)

    @property
    def converged(self) -> bool:
        """Whether all equilibria are converged and finite."""
        return bool(self.solved.all())

    @property
    def status(self) -> Status:
        """`Status.CONVERGED` if all equilibria have converged, else `Status.NOT_CONVERGED`."""
        return Status.CONVERGED if self.converged else Status.NOT_CONVERGED

    def with_notes(self, notes: tuple[Note, ...], error: ModelError | None = None) -> Curve:
        """Return the curve with other notes and, if given, another error; cached results are retained."""
        error = self.error if error is None else error
        return replace(self, notes=notes, error=error, compute_last=lambda: self.last)

    def checked(self) -> Curve:
        """Return the curve if it has converged; otherwise raise NotConverged with the curve attached."""
        if not self.converged:
            raise NotConverged(
                f"not converged: largest residual {self.residual[~self.solved].max():.2g}", self
            )
        return self


def _largest(errors: list[ModelError | None]) -> ModelError | None:
    """Return the largest of several errors; nan if one of them is nan, None if one of them is not known."""
    known = [error for error in errors if error is not None]
    return max(known, key=lambda error: (math.isnan(error), error)) if len(known) == len(errors) else None


def controlled(load: FloatArray | None, approach: FloatArray | None) -> tuple[FloatArray, bool]:
    """Return the one array that is not None, and whether it contains loads."""
    if (load is None) == (approach is None):
        raise InvalidInput("a curve needs either load [mm^2] or approach [mm]")
    by_load = load is not None
    return np.asarray(load if by_load else approach, dtype=np.float64), by_load


def refuse_unloading(law: Contact, unloading: bool) -> None:
    """Raise InvalidInput for unloading of plastic contacts, whose law on unloading is not known."""
    if unloading and law.plastic:
        raise InvalidInput(
            f"unloading = True: {law} describes the first loading alone, after which plastic contacts stay "
            "flattened; use a law without plasticity, or unloading=False"
        )


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """A curve at loads (k,), and derivatives of A0 at fixed load by the height of each asperity.

    Attributes
    ----------
    curve : Curve
    compute_gradient : callable
        Function that returns dA0/dh [mm], (k, n); it is called when `gradient` is first read.
    indentation : ndarray, (k, n)
        Nominal indentation of each asperity [mm], at which the law without the curvature of the neighbours'
        field gives its load; minus the gap of an open asperity.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> mf.Interacting().sensitivity(surface, np.array([0.02])).gradient.round(3)
    array([[ 0.205, -0.205]])
    """

    curve: Curve
    compute_gradient: Callable[[], FloatArray]
    indentation: FloatArray

    @cached_property
    def gradient(self) -> FloatArray:
        """Derivatives of A0, dA0/dh [mm], (k, n)."""
        return self.compute_gradient()


def areas_one_by_one(
    curve_of: Callable[[Surface, FloatArray], Curve],
    surface: Surface,
    load: FloatArray,
    *arrays: FloatArray | None,
) -> FloatArray:
    """Return A0 [mm^2] of many surfaces, (m, k), by one curve each; see `Model.areas`.

    arrays: heights, radii and positions; None for those of the surface.
    """
    names = ("height", "radius", "position")
    given = {name: values for name, values in zip(names, arrays, strict=True) if values is not None}
    found = np.full((len(given["height"]), len(load)), np.nan)
    for row in range(len(found)):
        with suppress(NotConverged):
            changed = surface.replaced(**{name: values[row] for name, values in given.items()})
            curve = curve_of(changed, load)
            found[row] = np.where(curve.solved, curve.area, np.nan)
    return found


class WithGradients:
    """Base of models that solve the asperities of a surface, with the derivatives by their heights."""

    couples: ClassVar[bool]
    unloads: ClassVar[bool] = True

    def bound(self, surface: Surface) -> Any:
        """Return the asperities of a surface, with `path`, `sensitivity` and `areas`."""
        raise NotImplementedError

    @property
    def gradient_model(self) -> Self:
        """The model itself."""
        return self

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
        values, by_load = controlled(load, approach)
        found: Curve = self.bound(surface).path(values, by_load, unloading)
        return found

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Return the law at increasing rescaled loads (k,), and dA0/dh at fixed load [mm], (k, n).

        height: summit heights (n,) [mm] that replace the heights of the surface; they are not checked.
        """
        heights = surface.height if height is None else height
        found: Sensitivity = self.bound(surface).sensitivity(heights, load)
        return found

    def areas(
        self, surface: Surface, load: FloatArray, height: FloatArray, radius: Any = None, position: Any = None
    ) -> FloatArray:
        """Return A0 [mm^2] of many surfaces at increasing rescaled loads (k,), (m, k); nan if not converged.

        height, radius: (m, n) [mm]; position: (m, n, 2) [mm]; default: the surface's. Surfaces of coupled
        asperities are solved one by one if positions are passed, or if radii are passed and fast sums are
        used.
        """
        if self.couples and position is not None:
            return areas_one_by_one(self.curve, surface, load, height, radius, position)
        found: FloatArray = self.bound(surface).areas(height, radius, load)
        return found
