"""Onset of sliding: the friction force against the tangential displacement, at a fixed normal load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from metafem import _validate as check
from metafem import drawing
from metafem._validate import FloatArray
from metafem._values import MICROMETRES, Value
from metafem.errors import InvalidInput
from metafem.models import Model
from metafem.prediction.state import ContactState, equilibrium
from metafem.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class Onset(Value):
    """Friction force against the tangential displacement of one surface at one normal load.

    Attributes
    ----------
    displacement : ndarray, (m,)
        Displacements at which the m contacts start to slide, increasing [mm].
    friction_force : ndarray, (m,)
        Friction force at these displacements [N]; the last one is that of full sliding.
    stiffness : float
        Tangential stiffness before the first contact slides [N/mm].
    state : ContactState
        The state under the normal load.

    Examples
    --------
    >>> import metafem as mf
    >>> friction = mf.Friction(0.404, 0.85)
    >>> material = mf.Material(1.36)
    >>> surface = Surface.square_lattice(
    ...     [0.1, 0.12], (1, 2), radius=0.526, material=material, friction=friction
    ... )
    >>> found = mf.onset(surface, load=0.02)
    >>> found.friction_force.round(4)
    array([0.0367, 0.0431])
    >>> found
    <Onset: load 0.02 N, 2 contacts, full sliding at 0.09454 mm and 0.04314 N, stiffness 0.5083 N/mm>
    """

    displacement: FloatArray
    friction_force: FloatArray
    stiffness: float
    state: ContactState

    def __post_init__(self) -> None:
        for values in (self.displacement, self.friction_force):
            values.flags.writeable = False

    def __repr__(self) -> str:
        count = f"{len(self.displacement)} contacts"
        end = f"full sliding at {self.displacement[-1]:.4g} mm and {self.friction_force[-1]:.4g} N"
        return f"<Onset: load {self.state.load:.4g} N, {count}, {end}, stiffness {self.stiffness:.4g} N/mm>"

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the friction force against the displacement, and mark where contacts start to slide."""
        ax = drawing.axes(ax)
        x, force = MICROMETRES * self.displacement, self.friction_force
        ax.plot([0.0, *x, 1.1 * x[-1]], [0.0, *force, force[-1]], color=drawing.ACHIEVED, lw=1.8)
        ax.plot(x, force, ".", color=drawing.TARGET, ms=4)
        ax.set(xlabel="tangential displacement  x [µm]", ylabel="friction force  F [N]")
        ax.set(xlim=(0.0, None), ylim=(0.0, None))
        return ax


def onset(surface: Surface, model: Model | None = None, *, load: float) -> Onset:
    """Return the onset of sliding of a surface at a fixed normal load.

    Contact i has the tangential stiffness ``8 G* a_i``, with ``G* = G/(2 - nu) = E* (1 - nu)/(2 (2 - nu))``
    against a rigid plane, and slides at the force ``sigma_i B_i A_i``. The force at the displacement x is
    ``F(x) = sum_i min(8 G* a_i x, sigma_i B_i A_i)``. Contact i starts to slide at
    ``sigma_i B_i pi a_i/(8 G*)``: of equal friction, small contacts slide first, and all slide at that of the
    largest. The first stiffness is ``8 G* sum a_i``, and F of full sliding is that of the friction law.

    The tangential displacements by other contacts and partial slip within a contact are left out, as is the
    change of the area before sliding; B is that of full sliding.
    Mindlin, J. Appl. Mech. 16, 259 (1949), doi:10.1115/1.4009973.

    Parameters
    ----------
    surface : Surface
        Surface with a `Friction`.
    model : Model, optional
        Model of the normal contact; default: `Independent()`.
    load : float
        Normal load P [N], positive.

    Returns
    -------
    Onset

    Raises
    ------
    InvalidInput
        If the surface has no friction, the load is out of range, or no asperity is in contact.
    NotConverged
        If the residual exceeds the model's tolerance.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = Surface.square_lattice(
    ...     0.1, (2, 2), radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.404)
    ... )
    >>> found = onset(surface, load=0.2)
    >>> found.displacement[-1].round(4), found.friction_force[-1].round(4)
    (np.float64(0.1707), np.float64(0.3019))
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    friction, ratio = surface.friction, surface.material.poisson_ratio
    if friction is None:
        words = "onset needs the surface's friction; create the surface with"
        raise InvalidInput(f"{words} friction=metafem.Friction(shear_strength, area_ratio)")
    state = equilibrium(surface, model, load=check.number("load", load, above=0.0))
    area = state.asperity_area[state.asperity_area > 0.0]
    modulus = surface.material.composite_modulus * (1.0 - ratio) / (2.0 * (2.0 - ratio))
    stiffness = 8.0 * modulus * np.sqrt(area / np.pi)
    force = friction.stress * area
    order = np.argsort(force / stiffness, kind="stable")
    displacement = (force / stiffness)[order]
    # contacts that slide, and the stiffness of those that stick
    stuck = stiffness.sum() - np.cumsum(stiffness[order])
    carried = np.cumsum(force[order]) + displacement * np.maximum(stuck, 0.0)
    return Onset(displacement, carried, float(stiffness.sum()), state)
