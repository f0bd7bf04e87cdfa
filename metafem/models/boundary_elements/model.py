"""Resolved contacts: pressures on the cells of a grid, without a law for single contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar, cast

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput, shown
from metafem.models.boundary_elements.cells import Scene
from metafem.models.boundary_elements.solve import COARSEST, initial_guess, solve
from metafem.models.curve import Curve, controlled
from metafem.models.error import order_3_error
from metafem.models.model import WithoutGradients
from metafem.notes import information
from metafem.progress import each
from metafem.substrate import HalfSpace, Radial
from metafem.surface import Surface


def resolvable(contact: object) -> bool:
    """Return whether a contact law is an elastic cap without adhesion, with a profile for the cells."""
    if isinstance(contact, type) or not isinstance(contact, Contact):
        return False
    return contact.largest_order == 3 and not contact.adhesive and hasattr(contact, "depth_at")


@dataclass(frozen=True)
class BoundaryElements(WithoutGradients):
    """Elastic contact of caps with a rigid plane, resolved by cells of constant pressure.

    The pressures satisfy ``p >= 0, u + gap - approach >= 0, p (u + gap - approach) = 0``. The displacement u
    is the sum of Love's solutions for all cells and the regular part of the substrate. Only the
    neighbourhoods of the contacts have cells. With n cells per contact radius the relative error of a Hertz
    contact at any position is at most 0.12/n^2 in load and 0.37/n^2 in area: 5e-5 and 1.5e-4 at n = 50. The
    stiffness is that of flat punches on the cells in contact. Johnson, Contact Mechanics (1985), section 5.9,
    doi:10.1017/CBO9781139171731.

    A surface with a periodic cell is refused. Inversions use the sensitivities of `gradient_model`.

    The contact areas are computed from the second moments of the pressure of each contact. For paraboloids
    ``A = 5 pi sqrt(<x^2><y^2> - <xy>^2)``, which is exact for Hertzian ellipses; for other caps the factor
    follows from their law with an extra curvature. If a contact has another shape or has merged, the area
    within its edge is used, with an error of a few cells per asperity and up to 1 % where contacts have
    merged, and a note states this.

    With fine cells the time for one load is about proportional to the number of cells, and thus increases
    fourfold if the cell is halved: half a million cells in contact take seconds. The memory is at most 320
    bytes for each cell, and 128 n^2 for n asperities, which is 13 GB for 10,000. An error is raised if a
    scene needs more memory than the machine has.

    Parameters
    ----------
    cell : float
        Side of the cells [mm], positive. If the largest contact has fewer than four cells per radius at a
        load, order 3 is used at this load; InvalidInput is raised if this applies to all loads. If only
        smaller contacts have fewer cells, a note states their share of the load.
    substrate : HalfSpace or BondedLayer
        A substrate whose influence depends only on the distance. The influence of `metafem.fe.Block3D`
        depends on the position in the block; use `Interacting` with this substrate.
    contact : Contact
        Elastic cap without adhesion; its profile is used: `Hertz()` (default), `Elastic()` or another class
        with `depth_at`.

    Raises
    ------
    InvalidInput
        If the cell is not positive, or the substrate or contact is of another kind. When solving: if the
        surface has a periodic cell, the cells are too coarse for the largest contact, a contact is wider than
        its profile, or the scene needs more memory than the machine has.

    Examples
    --------
    >>> from metafem import Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (1, 2), pitch=1.0, radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, BoundaryElements(cell=0.01), load=0.1)
    >>> round(state.area, 3), state.residual < 1e-9
    (0.373, True)
    """

    title: ClassVar[str] = "resolved"

    cell: float
    substrate: Radial = field(default_factory=HalfSpace)
    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        check.member(self, "cell", above=0.0)
        if not isinstance(self.substrate, Radial):
            raise InvalidInput(
                f"substrate = {self.substrate!r} must be one whose influence depends on the distance "
                "alone: metafem.HalfSpace() or metafem.BondedLayer()"
            )
        if not resolvable(self.contact):
            raise InvalidInput(
                f"contact = {shown(self.contact)} must be an elastic cap without adhesion, such as "
                "metafem.Hertz() or metafem.Elastic(): contacts of other laws cannot be resolved"
            )

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Return equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,).

        At light loads, for which the cells are too coarse, order 3 is used. It is more accurate there,
        because the contacts are far smaller than their distances.
        """
        values, by_load = controlled(load, approach)
        scene = Scene(surface, self.cell, self.substrate, self.contact.bound(surface))
        guesses = [initial_guess(scene, value, by_load) if value > 0.0 else None for value in values.tolist()]
        least = COARSEST * self.cell
        fine = [guess is not None and scene.largest(guess.last.indentation) >= least for guess in guesses]
        light = fine.index(True) if True in fine else guesses.count(None)
        parts = [self._light(surface, values[:light], by_load)] if light else []
        for k in each("resolved contacts: load", list(range(light, len(values)))):
            parts.append(solve(scene, cast("Curve", guesses[k]), float(values[k]), by_load, self))
        return Curve.joined(parts)

    def _light(self, surface: Surface, values: FloatArray, by_load: bool) -> Curve:
        """Return the part of a curve without contact, or at loads too light for the cells, by order 3."""
        model = self.gradient_model
        first = model.curve(surface, values) if by_load else model.curve(surface, approach=values)
        error = order_3_error(surface, first.last.area, self.substrate, self.contact)
        end = surface.material.composite_modulus * first.load[-1]
        note = information(
            f"up to {end:.4g} N the law is that of the model {model.name}: the largest contact "
            f"has fewer than {COARSEST:g} cells of {self.cell:g} mm per radius"
        )
        return first.with_notes((*first.notes, *([note] if end > 0.0 else ())), error)


def within(
    tolerance: float,
    surface: Surface,
    substrate: Radial,
    contact: Contact = PARABOLOID,
    **control: FloatArray,
) -> tuple[BoundaryElements, Curve]:
    """Return the model whose stated error of A0 is within a tolerance, and its curve.

    control: loads or approaches (k,), by the name of the argument of `curve`. The contacts are resolved by
    coarse cells and by half of them, at the first and at the last value. The stated errors tell the side of
    the cells. It is chosen again while more contacts are found deformed or merged by these cells. Each
    choice has smaller cells by a tenth at least. With more than 500,000 in contact, which take about ten
    seconds on two cores, the error remains above the tolerance, as the state says.
    """
    ((name, values),) = control.items()
    ends = values[values > 0.0][[0, -1]]
    scene = Scene(surface, 1.0, substrate, contact.bound(surface))  # [mm], before the contacts are known
    # ten cells per radius of the largest contact, also the minimum number
    cell = scene.largest(initial_guess(scene, ends[0], name == "load").last.indentation) / 10.0
    coarse = BoundaryElements(cell, substrate, contact)
    halved = replace(coarse, cell=0.5 * coarse.cell)
    curves = [model.curve(surface, **{name: ends}) for model in (coarse, halved)]
    before, found = (float(curve.error or 0.0) for curve in curves)
    # along grooves the error is proportional to the cell, elsewhere to its square
    rate = min(max(math.log2(before / found), 1.0), 2.0)
    # contacts may change their shape, which a tenth allows for
    cell = 0.9 * halved.cell * (tolerance / found) ** (1.0 / rate)
    least = math.sqrt(float(curves[1].area.max()) / 5e5)
    model = replace(coarse, cell=min(coarse.cell, max(cell, least)))
    curve = model.curve(surface, **control)
    while (error := float(curve.error or 0.0)) > tolerance and model.cell > least:
        model = replace(model, cell=max(0.9 * model.cell * (tolerance / error) ** (1.0 / rate), least))
        curve = model.curve(surface, **control)
    return model, curve
