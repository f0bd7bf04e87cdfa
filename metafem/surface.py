"""Surface with asperities on a block."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem import drawing
from metafem._validate import FloatArray
from metafem._values import Value, span
from metafem.caps import SPHERE, Cap
from metafem.caps.shapes import caps_of
from metafem.errors import InvalidInput, refuse_if
from metafem.material import Block, Friction, Material, PeriodicCell

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Block", "Friction", "Material", "PeriodicCell", "Surface"]

# Largest tilt [rad]. At larger tilts the direction of the heights is far from normal to the plane.
STEEPEST = 0.25 * math.pi


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Surface(Value):
    """Asperities on a block, pressed on a smooth rigid plane.

    Parameters
    ----------
    position : array_like, (n, 2)
        Positions of the summits in the base plane [mm]; no two may coincide.
    height : array_like, (n,)
        Heights of the summits above the undeformed base plane [mm]; any finite value.
    radius : float or array_like, (n,)
        R of each asperity [mm], positive: of a sphere or a paraboloid, the radius of curvature; it scales the
        profiles of other caps.
    material : Material
    friction : Friction, optional
        Required for friction forces; default: None.
    block : Block, optional
        Required for the bonded layer, the true block and the part files; default: None.
    cap : Cap or sequence of Cap
        Shape of all caps, or one for each asperity: `Sphere()` (default), `Paraboloid()`, `Power(...)` or
        `Profile(...)`.
    cell : PeriodicCell, optional
        Period of an infinite surface of which the asperities are one cell; default: None, no repetition.

    Raises
    ------
    InvalidInput
        If an array is empty, has the wrong shape or is not finite, a radius is not positive, two asperities
        coincide, a cap is not a shape, or the asperities do not fit in the cell.

    Examples
    --------
    >>> surface = Surface([[0, 0], [1.5, 0]], [0.10, 0.12], 0.526, Material(1.36))
    >>> surface.count, surface.radius
    (2, array([0.526, 0.526]))
    >>> surface
    <Surface: 2 asperities, heights 0.1 to 0.12 mm, radius 0.526 mm, E* 1.36 MPa, Poisson's ratio 0.5>
    """

    position: FloatArray
    height: FloatArray
    radius: FloatArray
    material: Material
    friction: Friction | None
    block: Block | None
    cap: Cap
    cell: PeriodicCell | None

    def __init__(
        self,
        position: ArrayLike,
        height: ArrayLike,
        radius: ArrayLike,
        material: Material,
        friction: Friction | None = None,
        block: Block | None = None,
        cap: Cap | Sequence[Cap] = SPHERE,
        cell: PeriodicCell | None = None,
    ) -> None:
        positions = check.array("position", position, shape=(None, 2))
        n = len(positions)
        heights = check.array("height", height, shape=(n,))
        radii = _radii(radius, n)
        _refuse_coincident(positions)
        check.instance("material", material, Material, "a metafem.Material")
        check.instance("friction", friction, Friction, "a metafem.Friction", optional=True)
        check.instance("block", block, Block, "a metafem.Block", optional=True)
        check.instance("cell", cell, PeriodicCell, "a metafem.PeriodicCell", optional=True)
        if cell is not None:
            _refuse_misfit(positions, radii, cell)
        shape = caps_of(cap, n)
        values = {"position": positions, "height": heights, "radius": radii, "cap": shape, "cell": cell}
        for name, given in {**values, "material": material, "friction": friction, "block": block}.items():
            object.__setattr__(self, name, given)

    @classmethod
    def square_lattice(
        cls,
        height: ArrayLike,
        shape: tuple[int, int] = (8, 8),
        pitch: float = 1.5,
        *,
        radius: ArrayLike,
        material: Material,
        friction: Friction | None = None,
        block: Block | None = None,
        cap: Cap | Sequence[Cap] = SPHERE,
        cell: PeriodicCell | None = None,
    ) -> Surface:
        """Return asperities on a square lattice centred on the origin, row by row along x.

        Parameters
        ----------
        height : array_like
            Summit heights [mm]: one number for all, (rows * columns,) or (rows, columns).
        shape : (int, int)
            Rows (along y) and columns (along x).
        pitch : float
            Distance between neighbours [mm], positive; default: 1.5.
        radius, material, friction, block, cap, cell
            As for `Surface`.

        Returns
        -------
        Surface

        Examples
        --------
        >>> lattice = Surface.square_lattice(0.1, (2, 3), 1.5, radius=0.526, material=Material(1.36))
        >>> lattice.position[:3, 0]
        array([-1.5,  0. ,  1.5])
        """
        try:
            rows, columns = shape
        except (TypeError, ValueError):
            raise InvalidInput(f"shape = {shape!r} must be (rows, columns)") from None
        rows = check.integer("shape[0]", rows, at_least=1)
        columns = check.integer("shape[1]", columns, at_least=1)
        many = f"shape = {shape!r} has {rows * columns:.3g} sites; at most 1e+08 are allowed"
        refuse_if(rows * columns > 1e8, many)  # more sites need gigabytes of memory
        step = check.number("pitch", pitch, above=0.0)
        radii = _radii(radius, rows * columns)
        x = step * (np.arange(columns) - 0.5 * (columns - 1))
        y = step * (np.arange(rows) - 0.5 * (rows - 1))
        position = np.column_stack([np.tile(x, rows), np.repeat(y, columns)])
        if check.scalar(height):
            height = np.full(rows * columns, check.number("height", height))
        elif np.ndim(height) > 1:
            height = check.array("height", height, shape=(rows, columns)).ravel()
        return cls(position, height, radii, material, friction, block, cap, cell)

    def __repr__(self) -> str:
        count, *rest = self._facts().items()
        return f"<Surface: {count[1]} asperities, {', '.join(f'{name} {words}' for name, words in rest)}>"

    def _facts(self) -> dict[str, str]:
        """Return the quantities for the printed summary."""
        facts = {
            "asperities": f"{self.count:,}",
            "heights": span(self.height, "mm"),
            "radius": span(self.radius, "mm"),
            **({} if self.cap == SPHERE else {"cap": repr(self.cap)}),
            "E*": f"{self.material.composite_modulus:.4g} MPa",
            "Poisson's ratio": f"{self.material.poisson_ratio:.4g}",
        }
        if self.friction is not None:
            facts["shear strength"] = f"{self.friction.shear_strength:.4g} MPa"
            facts["area ratio"] = f"{self.friction.area_ratio:.4g}"
        if self.block is not None:
            size = (self.block.width, self.block.length, self.block.thickness)
            facts["block"] = f"{' x '.join(f'{length:.4g}' for length in size)} mm"
        if self.cell is not None:
            facts["periodic cell"] = f"{self.cell.width:.4g} x {self.cell.length:.4g} mm"
        return facts

    @property
    def count(self) -> int:
        """Number of asperities."""
        return len(self.height)

    @property
    def gap(self) -> FloatArray:
        """Depth of each summit below the tallest, (n,) [mm], accurate also for small differences."""
        return np.asarray(self.height.max() - self.height)

    def replaced(self, **changes: Any) -> Surface:
        """Return a copy in which some arguments of the constructor are changed."""
        return replace(self, **changes)

    def only(self, some: Any, **changes: Any) -> Surface:
        """Return the surface of some asperities (indices or mask), with some arguments changed."""
        own = {name: getattr(self, name)[some] for name in ("position", "height", "radius")}
        return self.replaced(**{**own, "cap": self.cap.at(some), **changes})

    def tilted(self, angle_x: float, angle_y: float) -> Surface:
        """Return the surface tilted against the plane: heights ``h + x tan(angle_x) + y tan(angle_y)``.

        Parameters
        ----------
        angle_x, angle_y : float
            Tilt angles along x and y [rad], between -pi/4 and pi/4. The height at the origin does
            not change.

        Returns
        -------
        Surface

        Examples
        --------
        >>> pair = Surface([[0, 0], [1.5, 0]], [0.1, 0.1], 0.526, Material(1.36))
        >>> pair.tilted(0.002, 0.0).height.round(4)
        array([0.1  , 0.103])
        """
        self.refuse_tilt()
        slope = [
            math.tan(check.number(name, value, at_least=-STEEPEST, at_most=STEEPEST))
            for name, value in (("angle_x", angle_x), ("angle_y", angle_y))
        ]
        return self.replaced(height=self.height + self.position @ np.array(slope))

    def refuse_tilt(self) -> None:
        """Raise InvalidInput if the surface has a periodic cell: heights that rise along x do not repeat."""
        refuse_if(
            self.cell is not None,
            "a surface with a periodic cell cannot be tilted: heights that rise along x or y do not repeat; "
            "use cell=None, with some periods side by side",
        )

    def perturbed(self, height_sd: float, rng: Any = 0) -> Surface:
        """Return the surface with independent Gaussian height errors of standard deviation `height_sd` [mm].

        `rng` is a seed or a numpy Generator; default: 0.
        """
        sd = check.number("height_sd", height_sd, at_least=0.0)
        return self.replaced(height=self.height + sd * check.generator(rng).standard_normal(self.count))

    def shuffled(self, rng: Any = 0) -> Surface:
        """Return the surface with its asperities randomly assigned to its sites.

        Each asperity keeps its height, radius and cap.
        `rng` is a seed or a numpy Generator; default: 0.
        """
        generator = check.generator(rng)
        # `design` assigns sorted heights to sites by the first permutation of a seed; skip it, so that the
        # same seed does not undo that assignment
        generator.permutation(self.count)
        order = generator.permutation(self.count)
        return self.only(order, position=self.position)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the heights at their sites; marker sizes are proportional to the radii if these differ.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> lattice = Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=Material(1.36))
        >>> lattice.plot().get_xlabel()
        'x [mm]'
        """
        ax = drawing.axes(ax, 5.0, 4.2)
        if self.block is not None:
            drawing.outline(ax, self.block.width, self.block.length)
        drawing.summits(ax, self.position, self.height, self.radius)
        drawing.plan(ax)
        return ax


def _radii(radius: ArrayLike, count: int) -> FloatArray:
    """Return positive radii (count,) [mm] from one radius for all summits or one for each."""
    if check.scalar(radius):
        radius = np.full(count, check.number("radius", radius, above=0.0))
    return check.array("radius", radius, shape=(count,), positive=True)


def _refuse_coincident(position: FloatArray) -> None:
    # coordinates may be arbitrarily small, but those below SMALLEST count as zero
    rounded = np.where(np.abs(position) < check.SMALLEST, 0.0, position)
    order = np.lexsort(rounded.T)
    same = np.flatnonzero((rounded[order[1:]] == rounded[order[:-1]]).all(axis=1))
    if same.size:
        i, j = sorted(order[same[0] : same[0] + 2].tolist())
        x, y = position[i]
        both = f"entries {i + 1} and {j + 1} of position coincide at ({x:g}, {y:g})"
        raise InvalidInput(f"{both}; no two asperities may share a position")


def _refuse_misfit(position: FloatArray, radius: FloatArray, cell: PeriodicCell) -> None:
    """Refuse asperities larger than a cell, beyond one period, or coincident in another period."""
    sides, largest, extent = np.array([cell.width, cell.length]), radius.max(), np.ptp(position, axis=0)
    for name, side, reach in zip(("width", "length"), sides.tolist(), extent, strict=True):
        given: dict[str, Any] = {"key": f"cell.{name}", "value": side}
        wider = f"is smaller than the largest radius, {largest:g} mm; one period must be wider than that"
        refuse_if(side < largest, wider, **given)
        larger = f"is smaller than the extent of the positions, {reach:g} mm; enlarge the cell, or subtract "
        refuse_if(side < reach, larger + "multiples of its sides from positions", **given)
    if len(position) > 1:
        place = np.mod(position - position.min(axis=0), sides)
        distance, other = scipy.spatial.cKDTree(place, boxsize=sides).query(place, k=2)
        i = int(distance[:, 1].argmin())
        refuse_if(
            bool(distance[i, 1] <= 1e-9 * sides.min()),
            f"entries {i + 1} and {other[i][other[i] != i][0] + 1} of position coincide in another period of "
            f"the cell, {cell.width:g} x {cell.length:g} mm; remove one of them",
        )
