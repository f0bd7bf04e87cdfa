"""The friction law of a surface: its curve, rescaled values and fits of branches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem import drawing
from metafem._calls import checked_call
from metafem._validate import FloatArray
from metafem._values import Value, span
from metafem.errors import InvalidInput, NotConverged
from metafem.models import Curve, Independent, Model, Status
from metafem.models.model import checked_model
from metafem.notes import Note, counted, late_notes, when_read
from metafem.prediction import tables
from metafem.prediction.validity import REMEDY, left_out_notes
from metafem.surface import Friction, Material, Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame
    from xarray import Dataset

__all__ = ["BranchFit", "FrictionLaw", "friction_law"]

# Arrays of a law, with one entry for each load.
ARRAYS = ("load", "area", "separation", "approach", "stiffness", "residual")

# Number of loads of the default grid.
GRID_POINTS = 100

# Indentation of the lowest asperity at the end of the default grid over its radius: a/R = 0.2.
GRID_INDENTATION = 0.04

# The default grid ends at this fraction of the tallest height, before the plane reaches the base plane.
CLEAR = 0.999


@dataclass(frozen=True)
class BranchFit:
    """Straight line through a branch of a law, in rescaled load and friction.

    Attributes
    ----------
    slope : float
        Slope m [-]; the friction coefficient is about ``sigma B / E* m``.
    intercept : float
        Friction at zero load [mm^2].
    slope_interval, intercept_interval : (float, float)
        68 % confidence intervals of the regression.
    load_range : (float, float)
        Range of the rescaled loads of the fitted points [mm^2].
    points : int
        Number of points.
    friction_coefficient, friction_coefficient_interval : float and (float, float), or None
        ``dF/dP = sigma B / E* m`` [-] and its 68 % interval; None for a surface without a Friction.
    intercept_force, intercept_force_interval : float and (float, float), or None
        Friction force at zero load [N] and its 68 % interval; None for a surface without a Friction.
    """

    slope: float
    intercept: float
    slope_interval: tuple[float, float]
    intercept_interval: tuple[float, float]
    load_range: tuple[float, float]
    points: int
    friction_coefficient: float | None = None
    friction_coefficient_interval: tuple[float, float] | None = None
    intercept_force: float | None = None
    intercept_force_interval: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class FrictionLaw(Value):
    """Friction law of one surface under one model at increasing loads; arrays (k,).

    Attributes
    ----------
    load : ndarray
        Normal load P [N].
    area : ndarray
        Real contact area A0 [mm^2].
    separation, approach : ndarray
        Distance of the plane from the undeformed base plane, and tallest summit minus separation [mm].
    stiffness : ndarray
        Normal contact stiffness, dP per decrease of the separation [N/mm].
    residual : ndarray
        Relative error of the equations [-], recomputed on the returned state.
    status : Status
    model : Model
    material : Material
    friction : Friction or None
    notes : tuple of Note
        Skipped computations with their bounds, and effects that the model neglects. They are estimated
        when `notes` is first read.

    Examples
    --------
    >>> surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=Material(1.36))
    >>> law = friction_law(surface, load=[0.1, 0.2])
    >>> law.rescaled_friction.round(4)
    array([0.4708, 0.7474])
    >>> law
    <FrictionLaw: 2 loads 0.1 to 0.2 N, area 0.4708 to 0.7474 mm^2, Independent(), converged, 1 warning>
    """

    load: FloatArray
    area: FloatArray
    separation: FloatArray
    approach: FloatArray
    stiffness: FloatArray
    residual: FloatArray
    status: Status
    model: Model
    material: Material
    friction: Friction | None = None
    notes: tuple[Note, ...] = late_notes()

    def __post_init__(self) -> None:
        arrays = {name: getattr(self, name) for name in ARRAYS}
        for name, values in arrays.items():
            if values.ndim != 1 or values.shape != self.load.shape or not values.size:
                raise InvalidInput(
                    f"{name} has shape {values.shape}; the arrays of a law have one entry for each load"
                )
            values.flags.writeable = False
        if self.status is Status.CONVERGED:  # the last state of a failed solver may be arbitrary
            self._refuse_impossible(arrays)

    def _refuse_impossible(self, arrays: Mapping[str, FloatArray]) -> None:
        for name, values in arrays.items():
            bad = ~np.isfinite(values) if name in ("separation", "approach") else ~(values >= 0.0)
            if bad.any():
                i = int(bad.argmax())
                raise InvalidInput(f"{name}[{i}] = {values[i]:g} is impossible in a converged law")
        if (np.diff(self.load) < 0.0).any():
            raise InvalidInput("the loads of a law must not decrease")

    def __repr__(self) -> str:
        return (
            f"<FrictionLaw: {len(self.load)} loads {span(self.load, 'N')}, area {span(self.area, 'mm^2')}, "
            f"{self.model!r}, {self.status.name.lower()}, {counted(self.notes)}>"
        )

    @property
    def rescaled_load(self) -> FloatArray:
        """P/E* [mm^2]."""
        return self.load / self.material.composite_modulus

    @property
    def rescaled_friction(self) -> FloatArray:
        """F/(sigma B) = A0 [mm^2]."""
        return self.area

    @property
    def friction_force(self) -> FloatArray:
        """F = sigma B A0 [N]; raises InvalidInput for a surface without a Friction."""
        if self.friction is None:
            raise InvalidInput(
                "friction_force needs the surface's friction; create the surface with "
                "friction=metafem.Friction(shear_strength, area_ratio)"
            )
        return self.friction.shear_strength * self.friction.area_ratio * self.area

    @property
    def friction_coefficient(self) -> FloatArray:
        """F/P [-], infinite at a load of zero; raises InvalidInput for a surface without a Friction."""
        force = self.friction_force
        ratio = np.full(force.shape, np.inf)
        np.divide(force, self.load, out=ratio, where=self.load > 0.0)
        return ratio

    @checked_call
    def fit(
        self, load_range: tuple[float, float] | None = None, *, load: tuple[float, float] | None = None
    ) -> BranchFit:
        """Fit a straight line to the branch between two loads.

        Least squares of `rescaled_friction` against `rescaled_load`, with Student's 68 % intervals.

        Parameters
        ----------
        load_range : (float, float), optional
            Lower and upper rescaled load P/E* [mm^2].
        load : (float, float), optional
            Lower and upper load P [N], instead of `load_range`.

        Raises
        ------
        InvalidInput
            If the range is not increasing or contains fewer than three points, or if none or both of the
            ranges are given.

        Examples
        --------
        >>> surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=Material(1.36))
        >>> law = friction_law(surface, load=np.linspace(0.1, 0.2, 11))
        >>> round(law.fit((0.07, 0.15)).slope, 2)
        3.75
        >>> law.fit(load=(0.1, 0.2)).points
        11
        """
        from scipy.special import stdtrit

        low, high = self._fitted_range(load_range, load)
        x, y = self.rescaled_load, self.rescaled_friction
        # Loads at the ends of the range belong to the branch in spite of rounding.
        slack = 1e-12 * abs(high)
        chosen = (x >= low - slack) & (x <= high + slack)
        count = int(chosen.sum())
        if high <= low:
            raise InvalidInput(f"load_range = ({low:g}, {high:g}) must increase")
        if count < 3 or np.ptp(x[chosen]) == 0.0:
            raise InvalidInput(
                f"load_range = ({low:g}, {high:g}) holds {count} of the law's points, which run from "
                f"{x.min():g} to {x.max():g} mm^2; a fit needs at least 3 points, "
                "at different loads"
            )
        x, y = x[chosen], y[chosen]
        centre, spread = x.mean(), ((x - x.mean()) ** 2).sum()
        slope = float(((x - centre) * (y - y.mean())).sum() / spread)
        intercept = float(y.mean() - slope * centre)
        variance = float(((y - intercept - slope * x) ** 2).sum()) / (count - 2)
        student = float(stdtrit(count - 2, 0.84))  # 68 % two-sided
        slope_error = student * float(np.sqrt(variance / spread))
        intercept_error = student * float(np.sqrt(variance * (1.0 / count + centre**2 / spread)))
        slopes = slope - slope_error, slope + slope_error
        intercepts = intercept - intercept_error, intercept + intercept_error
        fit = BranchFit(slope, intercept, slopes, intercepts, (low, high), count)
        if self.friction is None:
            return fit
        stress = self.friction.shear_strength * self.friction.area_ratio
        per_slope = stress / self.material.composite_modulus
        return replace(
            fit,
            friction_coefficient=per_slope * slope,
            friction_coefficient_interval=(per_slope * slopes[0], per_slope * slopes[1]),
            intercept_force=stress * intercept,
            intercept_force_interval=(stress * intercepts[0], stress * intercepts[1]),
        )

    def _fitted_range(
        self, load_range: tuple[float, float] | None, load: tuple[float, float] | None
    ) -> tuple[float, float]:
        """Return the range of rescaled loads from a range in mm^2 or N."""
        if (load_range is None) == (load is None):
            raise InvalidInput("a fit needs either load_range [mm^2] or load [N]")
        if load is None:
            low, high = check.array("load_range", load_range, shape=(2,)).tolist()
        else:
            newtons = check.array("load", load, shape=(2,))
            low, high = (newtons / self.material.composite_modulus).tolist()
        return low, high

    def to_dataframe(self) -> DataFrame:
        """Return the law as a table with a row for each load.

        Returns
        -------
        pandas.DataFrame
            Columns named by quantity and unit as in ``law.csv``: ``load_N``, ``area_mm2``,
            ``separation_mm``, ``rescaled_load_mm2``, ``rescaled_friction_mm2``, with a Friction
            ``friction_force_N`` and ``friction_coefficient``, ``approach_mm``, ``stiffness_N_per_mm`` and
            ``residual``. Its ``attrs`` hold model, status and notes as texts.

        Examples
        --------
        >>> surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=Material(1.36))
        >>> table = friction_law(surface, load=[0.1, 0.2]).to_dataframe()
        >>> table["area_mm2"].round(4).tolist(), table.attrs["model"]
        ([0.4708, 0.7474], 'Independent()')
        """
        return tables.dataframe(self)

    def to_xarray(self) -> Dataset:
        """Return the law over its rescaled loads.

        Returns
        -------
        xarray.Dataset
            ``load``, ``area``, ``separation``, ``rescaled_friction``, with a Friction ``friction_force``
            and ``friction_coefficient``,
            ``approach``, ``stiffness`` and ``residual`` over the dimension ``rescaled_load``, each with its
            ``units`` and ``long_name``. Its ``attrs`` hold model, status and notes as texts.

        Examples
        --------
        >>> surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=Material(1.36))
        >>> data = friction_law(surface).to_xarray()
        >>> data.sizes["rescaled_load"], data.area.attrs["units"]
        (100, 'mm2')
        """
        return tables.dataset(self)

    def plot(
        self, ax: Axes | None = None, units: Literal["mm^2", "N"] = "mm^2", label: str | None = None
    ) -> Axes:
        """Draw the law and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.
        units : {"mm^2", "N"}
            Rescaled friction over rescaled load [mm^2], or friction force over load [N].
        label : str, optional
            Label for a legend.

        Raises
        ------
        InvalidInput
            For other units, for an `ax` that is not a matplotlib Axes, and for forces of a surface without
            a Friction.

        Examples
        --------
        >>> surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=Material(1.36))
        >>> ax = friction_law(surface).plot(label="four asperities")
        >>> ax.get_xlabel()
        'rescaled load  P/E* [mm²]'
        """
        if units not in ("mm^2", "N"):
            raise InvalidInput(f'units = {units!r:.40} must be "mm^2" (rescaled) or "N" (forces)')
        forces = units == "N"
        if forces:
            x, y = self.load, self.friction_force
        else:
            x, y = self.rescaled_load, self.rescaled_friction
        ax = drawing.axes(ax)
        drawing.law(ax, x, y, forces=forces, label=label)
        return ax


@checked_call
def friction_law(
    surface: Surface,
    model: Model | None = None,
    *,
    load: ArrayLike | None = None,
    separation: ArrayLike | None = None,
) -> FrictionLaw:
    """Predict the friction law of a surface.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        Default: `Independent()`.
    load : array_like, (k,), optional
        Normal loads P [N], at least 0.
    separation : array_like, (k,), optional
        Separations [mm]. Default, if neither is given: 100 loads up to the one at which the lowest asperity
        is indented by 0.04 R or the plane reaches the base plane.

    Returns
    -------
    FrictionLaw
        Ordered by increasing load.

    Raises
    ------
    InvalidInput
        For negative or non-finite loads, non-finite separations, or both at once.
    NotConverged
        If a residual exceeds the model's tolerance.

    Examples
    --------
    >>> surface = Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=Material(1.36))
    >>> law = friction_law(surface, separation=[0.11, 0.09])
    >>> law.area.round(5)
    array([0.01652, 0.0661 ])
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    solver = checked_model(Independent() if model is None else model)
    if load is not None and separation is not None:
        raise InvalidInput("only one of load and separation can be given")
    top = float(surface.height.max())
    modulus = surface.material.composite_modulus
    if separation is not None:
        distance = np.sort(check.array("separation", separation, shape=(None,)))[::-1]
        curve = solver.curve(surface, approach=top - distance)
    else:
        if load is None:
            end = solver.curve(surface, approach=np.array([_grid_end(surface)])).load[0]
            rescaled = end * np.arange(1, GRID_POINTS + 1) / GRID_POINTS
        else:
            newtons = np.sort(check.array("load", load, shape=(None,)))
            if newtons[0] < 0.0:
                raise InvalidInput(f"load holds {newtons[0]:g} N; loads must be at least 0 N")
            rescaled = newtons / modulus
        curve = solver.curve(surface, rescaled)
        distance = top - curve.approach
    return _law(surface, solver, curve, np.asarray(distance))


def _law(surface: Surface, model: Model, curve: Curve, separation: FloatArray) -> FrictionLaw:
    modulus = surface.material.composite_modulus
    law = FrictionLaw(
        load=modulus * curve.load,
        area=curve.area,
        separation=separation,
        approach=curve.approach,
        stiffness=modulus * curve.stiffness,
        residual=curve.residual,
        status=curve.status,
        model=model,
        material=surface.material,
        friction=surface.friction,
        notes=when_read(left_out_notes, surface, model, curve, curve.notes),
    )
    if not curve.converged:
        worst = curve.residual.max()
        raise NotConverged(f"{curve.status.value}: largest residual {worst:.2g}; {REMEDY}", law)
    return law


def _grid_end(surface: Surface) -> float:
    """Approach at which the default grid ends [mm]."""
    gaps = surface.gap
    lowest = int(gaps.argmax())
    end = float(gaps[lowest] + GRID_INDENTATION * surface.radius[lowest])
    top = float(surface.height.max())
    return min(end, CLEAR * top) if CLEAR * top > gaps[lowest] else end
