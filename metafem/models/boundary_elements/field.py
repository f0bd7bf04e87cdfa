"""Pressure, gap and displacement on the cells of resolved contacts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from metafem import drawing
from metafem._validate import FloatArray, IntArray
from metafem._values import Value, span

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class ContactField(Value):
    """Fields on the cells of `metafem.BoundaryElements`, arrays (k,) over all cells.

    The cells are squares of one common grid. They form m rectangular patches around the contacts; there are
    no cells between the patches. The arrays contain one patch after the other. Thus
    ``field.pressure[field.patch == 0].reshape(field.shape[0])`` is the pressure on the first patch, with x
    along the first axis and y along the second.

    Attributes
    ----------
    cell : float
        Side of the cells [mm].
    x, y : ndarray, (k,)
        Centres of the cells [mm].
    pressure : ndarray, (k,)
        Contact pressure [MPa], not negative; 0 outside the contacts. ``cell**2 * pressure.sum()`` is the load
        [N].
    gap : ndarray, (k,)
        Distance from the deformed surface to the plane [mm]. It is 0 in contact and not negative elsewhere,
        with errors up to 1e-9 of the largest indentation.
    displacement : ndarray, (k,)
        Displacement of the surface away from the plane, into the block [mm].
    patch : ndarray of int, (k,)
        Index of the patch of each cell, from 0.
    shape : ndarray of int, (m, 2)
        Number of cells of each patch along x and along y.
    corner : ndarray, (m, 2)
        Centre of the first cell of each patch [mm].
    undeformed_gap : ndarray, (k,)
        Distance from the undeformed surface to the plane [mm]; negative where they would overlap.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (1, 2), pitch=1.0, radius=0.526, material=mf.Material(1.36))
    >>> field = mf.equilibrium(surface, mf.BoundaryElements(cell=0.01), load=0.1).field
    >>> field
    <ContactField: 7200 cells of 0.01 mm in 2 patches, pressure 0 to 0.4022 MPa>
    >>> print(f"{field.cell**2 * field.pressure.sum():.6f} N")
    0.100000 N
    >>> bool((field.gap[field.pressure > 0.0] < 1e-10).all())
    True
    >>> first = field.pressure[field.patch == 0].reshape(field.shape[0])
    """

    cell: float
    corner: FloatArray
    shape: IntArray
    pressure: FloatArray
    gap: FloatArray
    undeformed_gap: FloatArray

    def __post_init__(self) -> None:
        for name in ("corner", "shape", "pressure", "gap", "undeformed_gap"):
            getattr(self, name).flags.writeable = False

    def __repr__(self) -> str:
        count = len(self.shape)
        patches = f"{count} patch{'es' * (count != 1)}"
        pressure = f", pressure {span(self.pressure, 'MPa')}" if self.pressure.size else ""
        return f"<ContactField: {len(self.pressure)} cells of {self.cell:g} mm in {patches}{pressure}>"

    @cached_property
    def patch(self) -> IntArray:
        """Index of the patch of each cell, (k,)."""
        return np.repeat(np.arange(len(self.shape)), self.shape.prod(axis=1))

    @cached_property
    def x(self) -> FloatArray:
        """Centres of the cells along x, (k,) [mm]."""
        return self._centres(0)

    @cached_property
    def y(self) -> FloatArray:
        """Centres of the cells along y, (k,) [mm]."""
        return self._centres(1)

    @cached_property
    def displacement(self) -> FloatArray:
        """Displacement of the surface away from the plane, (k,) [mm]."""
        return self.gap - self.undeformed_gap

    def _centres(self, axis: int) -> FloatArray:
        steps = [np.indices(shape)[axis].ravel() for shape in self.shape.tolist()]
        return np.asarray(self.corner[self.patch, axis] + self.cell * np.concatenate([np.zeros(0), *steps]))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the contact pressure as seen from above, and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: the axes of a new ``matplotlib.pyplot`` figure.

        Returns
        -------
        matplotlib Axes

        Examples
        --------
        >>> import metafem as mf
        >>> surface = mf.Surface([[0, 0], [1, 0]], [0.1, 0.1], 0.526, mf.Material(1.36))
        >>> state = mf.equilibrium(surface, mf.BoundaryElements(cell=0.02), load=0.1)
        >>> state.field.plot().get_ylabel()
        'y [mm]'
        """
        ax = drawing.axes(ax, 5.0, 4.2)
        parts = np.split(self.pressure, np.cumsum(self.shape.prod(axis=1))[:-1]) if len(self.shape) else []
        grids = [part.reshape(shape) for part, shape in zip(parts, self.shape.tolist(), strict=True)]
        drawing.grids(ax, self.corner, self.cell, grids, "pressure [MPa]")
        drawing.plan(ax)
        return ax
