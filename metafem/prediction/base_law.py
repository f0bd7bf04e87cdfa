"""Base class of predicted and measured friction laws: friction coefficient, fits, tables and figures."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy.special import stdtrit

from metafem import _validate as check
from metafem import drawing
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import refuse_if
from metafem.surface import Friction, Material

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame
    from xarray import Dataset

# Probability of values below the upper end of a two-sided 68 % interval of Student's distribution.
UPPER = 0.84

# Unit and meaning of each quantity of a law, in the order of the columns.
QUANTITIES = {
    "load": ("N", "normal load P"),
    "area": ("mm2", "real contact area A0"),
    "separation": ("mm", "glass to undeformed base plane"),
    "rescaled_load": ("mm2", "load over composite modulus, P/E*"),
    "rescaled_friction": ("mm2", "friction over shear strength and area ratio, F/(sigma B)"),
    "friction_force": ("N", "friction force F"),
    "friction_coefficient": ("1", "friction force over load, F/P"),
    "nominal_pressure": ("MPa", "load per area of the periodic cell, P/A"),
    "nominal_shear_stress": ("MPa", "friction force per area of the periodic cell, F/A"),
    "approach": ("mm", "tallest summit minus separation"),
    "stiffness": ("N/mm", "normal contact stiffness"),
    "residual": ("1", "relative error of the equations"),
}


def described(name: str, known: Mapping[str, tuple[str, str]] = QUANTITIES) -> dict[str, str]:
    """Return units and long name of a quantity or its statistic, such as ``area_sd_error``; {} if unknown.

    Examples
    --------
    >>> described("area_mean_error")
    {'units': 'mm2', 'long_name': 'real contact area A0, mean error'}
    """
    base = name if name in known else name.removeprefix("nominal_")
    quantity = max((each for each in known if f"{base}_".startswith(f"{each}_")), key=len, default=None)
    if quantity is None:
        return {}
    statistic = base.removeprefix(quantity).replace("_", " ")
    # a share of the variance has no unit, whatever the quantity
    share = "first order" in statistic or "total" in statistic
    unit, words = known[quantity]
    nominal = "" if base == name else "nominal "
    long = f"{nominal}{words}{',' if statistic else ''}{statistic}"
    return {"units": "1" if share else unit, "long_name": long}


@dataclass(frozen=True)
class BranchFit:
    """Straight line fitted to a branch of a law, rescaled friction over rescaled load.

    Attributes
    ----------
    slope : float
        Slope m [-]; the friction coefficient is about ``sigma B / E* m``.
    intercept : float
        Rescaled friction at zero load [mm^2].
    slope_interval, intercept_interval : (float, float)
        68 % confidence intervals from the regression.
    load_range : (float, float)
        Range of the rescaled loads of the fitted points [mm^2].
    points : int
        Number of points.
    friction_coefficient : float or None
        ``dF/dP = sigma B / E* m`` [-]; None for a surface without a Friction.
    intercept_force : float or None
        Friction force at zero load [N]; None for a surface without a Friction.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> fit = mf.friction_law(surface, load=np.linspace(0.1, 0.2, 11)).fit(load=(0.1, 0.2))
    >>> round(fit.slope, 2), round(fit.intercept, 2), fit.points, fit.friction_coefficient
    (3.75, 0.2, 11, None)
    """

    slope: float
    intercept: float
    slope_interval: tuple[float, float]
    intercept_interval: tuple[float, float]
    load_range: tuple[float, float]
    points: int
    friction_coefficient: float | None = None
    intercept_force: float | None = None


def fit_branch(
    load: FloatArray,
    area: FloatArray,
    load_range: tuple[float, float],
    material: Material,
    friction: Friction | None,
) -> BranchFit:
    """Return the least-squares line of rescaled friction over rescaled loads (k,) [mm^2], between two."""
    low, high = load_range
    refuse_if(high <= low, f"load_range = ({low:g}, {high:g}) must increase")
    chosen = (load >= low) & (load <= high) & ~np.isnan(area)  # areas of a measured law may be unknown
    count = int(chosen.sum())
    words = f"load_range = ({low:g}, {high:g}) holds {count} of the law's points, which run from"
    enough = count >= 3 and np.ptp(load[chosen]) > 0.0
    least = "a fit needs at least 3 points, at different loads"
    refuse_if(not enough, f"{words} {load.min():g} to {load.max():g} mm^2; {least}")
    line, covariance = np.polyfit(load[chosen], area[chosen], 1, cov=True)
    error = stdtrit(count - 2, UPPER) * np.sqrt(np.diag(covariance))
    (slope, intercept), low_end, high_end = line.tolist(), (line - error).tolist(), (line + error).tolist()
    intervals = (low_end[0], high_end[0]), (low_end[1], high_end[1])
    ratio = None if friction is None else friction.stress / material.composite_modulus * slope
    force = None if friction is None else friction.stress * intercept
    return BranchFit(slope, intercept, *intervals, (low, high), count, ratio, force)


class BaseLaw(Value):
    """Base class of `metafem.FrictionLaw` and `metafem.calibration.MeasuredLaw`, at k increasing loads."""

    if TYPE_CHECKING:  # members of the derived classes

        @property
        def load(self) -> FloatArray:
            """Normal load P [N], (k,)."""

        @property
        def rescaled_load(self) -> FloatArray:
            """Rescaled load P/E* [mm^2], (k,)."""

        @property
        def rescaled_friction(self) -> FloatArray:
            """Rescaled friction F/(sigma B) [mm^2], (k,)."""

        @property
        def material(self) -> Material:
            """Material of the block."""

        @property
        def friction(self) -> Friction | None:
            """Friction of the material pair, if it is known."""

    @abstractmethod
    def _force(self) -> FloatArray:
        """Return the friction forces [N], (k,); raise InvalidInput if they are not known."""

    @abstractmethod
    def quantities(self) -> dict[str, FloatArray]:
        """Return the arrays (k,) of the law by name, in the order of the columns of its tables."""

    @abstractmethod
    def _about(self) -> Mapping[str, str]:
        """Return the metadata of the law for its tables: model, status and notes."""

    @abstractmethod
    def _draw(self, ax: Axes, forces: bool, label: str | None) -> None:
        """Draw the law on axes, with forces [N] or rescaled quantities [mm^2]."""

    @property
    def friction_coefficient(self) -> FloatArray:
        """F/P [-], (k,), infinite at zero load; raises InvalidInput if the friction forces are not known."""
        force = self._force()
        ratio = np.full(force.shape, np.inf)
        np.divide(force, self.load, out=ratio, where=self.load > 0.0)
        return ratio

    def fit(
        self, load_range: tuple[float, float] | None = None, *, load: tuple[float, float] | None = None
    ) -> BranchFit:
        """Return a straight line fitted to the branch of the law between two loads.

        The fit is linear least squares of `rescaled_friction` against `rescaled_load`, with 68 % confidence
        intervals from Student's distribution.

        Parameters
        ----------
        load_range : (float, float), optional
            Lower and upper rescaled load P/E* [mm^2].
        load : (float, float), optional
            Lower and upper load P [N], instead of `load_range`.

        Raises
        ------
        InvalidInput
            If the range is not increasing or contains fewer than three points, or unless exactly one range is
            given.

        Examples
        --------
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> law = mf.friction_law(surface, load=np.linspace(0.1, 0.2, 11))
        >>> round(law.fit((0.07, 0.15)).slope, 2)
        3.75
        >>> law.fit(load=(0.1, 0.2)).points
        11
        """
        refuse_if((load_range is None) == (load is None), "a fit needs either load_range [mm^2] or load [N]")
        if load is None:
            ends = check.array("load_range", load_range, shape=(2,))
        else:
            ends = check.array("load", load, shape=(2,)) / self.material.composite_modulus
        low, high = ends.tolist()
        return fit_branch(
            self.rescaled_load, self.rescaled_friction, (low, high), self.material, self.friction
        )

    def columns(self) -> dict[str, FloatArray]:
        """Return the arrays (k,) by column name, which includes the unit: ``load_N``, ``area_mm2``."""
        units = {name: described(name)["units"].replace("/", "_per_") for name in self.quantities()}
        return {
            name if units[name] == "1" else f"{name}_{units[name]}": values
            for name, values in self.quantities().items()
        }

    def to_dataframe(self) -> DataFrame:
        """Return the law as a table with one row for each load.

        Returns
        -------
        pandas.DataFrame
            Columns named by quantity and unit, as in ``law.csv``: ``load_N``, ``area_mm2``,
            ``separation_mm``, ``rescaled_load_mm2``, ``rescaled_friction_mm2``, ``approach_mm``,
            ``stiffness_N_per_mm`` and ``residual``. With a Friction, there are also ``friction_force_N`` and
            ``friction_coefficient``, and with a periodic cell ``nominal_pressure_MPa`` and
            ``nominal_shear_stress_MPa``. The ``attrs`` of the table hold model, status and notes as texts.

        Examples
        --------
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> table = mf.friction_law(surface, load=[0.1, 0.2]).to_dataframe()
        >>> table["area_mm2"].round(4).tolist(), table.attrs["model"]
        ([0.4708, 0.7474], 'Independent()')
        """
        from pandas import DataFrame

        table = DataFrame({name: values.copy() for name, values in self.columns().items()})
        table.attrs.update(self._about())
        return table

    def to_xarray(self) -> Dataset:
        """Return the law as a dataset over the rescaled load.

        Returns
        -------
        xarray.Dataset
            ``load``, ``area``, ``separation``, ``rescaled_friction``, ``approach``, ``stiffness`` and
            ``residual`` over the dimension ``rescaled_load``, each with its ``units`` and ``long_name``. With
            a Friction, there are also ``friction_force`` and ``friction_coefficient``, and with a periodic
            cell ``nominal_pressure`` and ``nominal_shear_stress``. The ``attrs`` of the dataset hold model,
            status and notes as texts.

        Examples
        --------
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> data = mf.friction_law(surface).to_xarray()
        >>> data.sizes["rescaled_load"], data.area.attrs["units"]
        (100, 'mm2')
        """
        from xarray import Dataset

        variables = {
            name: ("rescaled_load", values.copy(), described(name))
            for name, values in self.quantities().items()
        }
        coordinate = {"rescaled_load": variables.pop("rescaled_load")}
        return Dataset(variables, coordinate, dict(self._about()))

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
            If the units are others, `ax` is not a matplotlib Axes, or forces are drawn for a surface without
            a Friction.

        Examples
        --------
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> ax = mf.friction_law(surface).plot(label="four asperities")
        >>> ax.get_xlabel()
        'rescaled load  P/E* [mm²]'
        """
        refuse_if(
            units not in ("mm^2", "N"), f'units = {units!r:.40} must be "mm^2" (rescaled) or "N" (forces)'
        )
        ax = drawing.axes(ax)
        self._draw(ax, units == "N", label)
        return ax
