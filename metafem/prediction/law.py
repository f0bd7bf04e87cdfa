"""The friction law of a surface: its arrays, forces, fits and tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from metafem import _validate as check
from metafem import drawing
from metafem._calls import checked_call
from metafem._validate import FloatArray
from metafem._values import Value, span
from metafem.errors import InvalidInput
from metafem.models import Model, Status
from metafem.notes import Note, counted, late_notes
from metafem.prediction import tables
from metafem.prediction.branch_fit import BranchFit, fit_branch
from metafem.surface import Friction, Material

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pandas import DataFrame
    from xarray import Dataset

# Arrays of a law, with one entry for each load.
ARRAYS = ("rescaled_load", "area", "separation", "approach", "rescaled_stiffness", "residual")

# Those that may be negative: loads only between adhesive contacts that are pulled apart.
SIGNED = ("rescaled_load", "separation", "approach")


@dataclass(frozen=True, eq=False, repr=False)
class FrictionLaw(Value):
    """Friction law ``F = sigma B A0(P)`` of one surface under one model at increasing loads; arrays (k,).

    sigma is the shear strength and B the area ratio of `metafem.Friction`. Rescaled, the law is A0 over P/E*.
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234.

    Attributes
    ----------
    rescaled_load : ndarray
        Normal load over composite modulus, P/E* [mm^2]; the given loads, not the sums over the asperities.
        Negative where adhesive contacts hold on unloading.
    area : ndarray
        Real contact area A0 [mm^2].
    separation, approach : ndarray
        Distance of the plane from the undeformed base plane, and tallest summit minus separation [mm].
    rescaled_stiffness : ndarray
        Normal contact stiffness over composite modulus, dP/E* per decrease of the separation [mm].
    residual : ndarray
        Relative error of the equations [-], recomputed on the returned state.
    status : Status
    model : Model
    material : Material
    friction : Friction or None
    notes : tuple of Note
        Skipped computations with their bounds, and effects that the model neglects. They are estimated
        when `notes` is first read.
    load, stiffness : ndarray
        Normal load P [N] and normal contact stiffness [N/mm].

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> law = mf.friction_law(surface, load=[0.1, 0.2])
    >>> law.rescaled_friction.round(4)
    array([0.4708, 0.7474])
    >>> law
    <FrictionLaw: 2 loads 0.1 to 0.2 N, area 0.4708 to 0.7474 mm^2, Independent(), converged, 1 warning>
    """

    rescaled_load: FloatArray
    area: FloatArray
    separation: FloatArray
    approach: FloatArray
    rescaled_stiffness: FloatArray
    residual: FloatArray
    status: Status
    model: Model
    material: Material
    friction: Friction | None = None
    notes: tuple[Note, ...] = late_notes()

    def __post_init__(self) -> None:
        arrays = {name: getattr(self, name) for name in ARRAYS}
        for name, values in arrays.items():
            if values.ndim != 1 or values.shape != self.rescaled_load.shape or not values.size:
                raise InvalidInput(
                    f"{name} has shape {values.shape}; the arrays of a law have one entry for each load"
                )
            values.flags.writeable = False
        if self.status is Status.CONVERGED:  # the last state of a failed solver may be arbitrary
            self._refuse_impossible(arrays)

    def _refuse_impossible(self, arrays: Mapping[str, FloatArray]) -> None:
        for name, values in arrays.items():
            signed = name in SIGNED
            bad = ~np.isfinite(values) if signed else ~(values >= 0.0)
            if bad.any():
                i = int(bad.argmax())
                raise InvalidInput(f"{name}[{i}] = {values[i]:g} is impossible in a converged law")
        if (np.diff(self.rescaled_load) < 0.0).any():
            raise InvalidInput("the loads of a law must not decrease")

    def __repr__(self) -> str:
        return (
            f"<FrictionLaw: {len(self.load)} loads {span(self.load, 'N')}, area {span(self.area, 'mm^2')}, "
            f"{self.model!r}, {self.status.name.lower()}, {counted(self.notes)}>"
        )

    @property
    def load(self) -> FloatArray:
        """P [N]."""
        return self.material.composite_modulus * self.rescaled_load

    @property
    def stiffness(self) -> FloatArray:
        """Normal contact stiffness [N/mm]."""
        return self.material.composite_modulus * self.rescaled_stiffness

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
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> law = mf.friction_law(surface, load=np.linspace(0.1, 0.2, 11))
        >>> round(law.fit((0.07, 0.15)).slope, 2)
        3.75
        >>> law.fit(load=(0.1, 0.2)).points
        11
        """
        if (load_range is None) == (load is None):
            raise InvalidInput("a fit needs either load_range [mm^2] or load [N]")
        if load is None:
            ends = check.array("load_range", load_range, shape=(2,))
        else:
            ends = check.array("load", load, shape=(2,)) / self.material.composite_modulus
        low, high = ends.tolist()
        return fit_branch(self.rescaled_load, self.area, (low, high), self.material, self.friction)

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
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> table = mf.friction_law(surface, load=[0.1, 0.2]).to_dataframe()
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
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> data = mf.friction_law(surface).to_xarray()
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
        >>> import metafem as mf
        >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
        >>> ax = mf.friction_law(surface).plot(label="four asperities")
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
