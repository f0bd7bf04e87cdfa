"""The friction law of a surface, and its prediction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem import drawing
from metafem._validate import FloatArray
from metafem._values import span
from metafem.errors import InvalidInput, NotConverged, refuse_if
from metafem.models import Curve, Independent, Model, Status
from metafem.models.curve import ModelError
from metafem.models.model import checked_model, contact_of, with_contact
from metafem.notes import Note, late, printed_count, to_lines
from metafem.prediction.base_law import QUANTITIES, BaseLaw
from metafem.prediction.validity import NOT_ESTIMATED, REMEDY, judged
from metafem.surface import Friction, Material, PeriodicCell, Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Arrays of a law, with one entry for each load.
ARRAYS = ("rescaled_load", "area", "separation", "approach", "rescaled_stiffness", "residual")

# Quantities that may be negative; the load is negative only when adhesive contacts are pulled apart.
SIGNED = ("rescaled_load", "separation", "approach")

# Number of loads of the default grid.
GRID_POINTS = 100

# Indentation of the lowest asperity at the end of the default grid, over its radius; a/R is then 0.2.
GRID_INDENTATION = 0.04

# Largest approach of the default grid, over the largest height. The grid ends just before the rigid plane
# reaches the base plane.
CLEAR = 0.999

# Largest approach of the default grid, over the approach at which a contact without neighbours reaches the
# largest indentation of its law. The margin allows for rounding, and for the different displacements of
# interacting asperities.
WITHIN = 0.98


@dataclass(frozen=True, eq=False, repr=False)
class FrictionLaw(BaseLaw):
    """Friction law ``F = sigma B A0(P)`` of one surface under one model, as arrays (k,) at increasing loads.

    sigma is the shear strength and B the area ratio of `metafem.Friction`. The rescaled law is A0 over P/E*.
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234.

    Attributes
    ----------
    rescaled_load : ndarray
        Normal load over composite modulus, P/E* [mm^2]: the prescribed loads, not the computed sums over the
        asperities. They are negative where adhesive contacts are in tension on unloading.
    area : ndarray
        Real contact area A0 [mm^2].
    separation, approach : ndarray
        Distance from the undeformed base plane to the rigid plane, and tallest summit minus separation [mm].
    rescaled_stiffness : ndarray
        Normal contact stiffness over composite modulus, the increase of P/E* per decrease of the separation
        [mm].
    residual : ndarray
        Relative error of the equations [-], recomputed on the returned states.
    status : Status
    model : Model
    material : Material
    friction : Friction or None
    notes : tuple of Note
        Approximations with their bounds, and estimates of neglected effects, computed when `notes` is first
        read.
    model_error : ModelError
        Largest estimated relative error of A0(P) over the loads, compared with resolved contacts on the same
        substrate; computed when it is first read. It is nan if it cannot be estimated; its `source` states
        the reason.
    cell : PeriodicCell or None
        Period of the surface; all loads and areas are those of one period.
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
    <FrictionLaw: 2 loads 0.1 to 0.2 N, area 0.4708 to 0.7474 mm^2, model Independent(), ...>
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
    notes: tuple[Note, ...] = late(())
    model_error: ModelError = late(NOT_ESTIMATED)
    cell: PeriodicCell | None = None

    def __post_init__(self) -> None:
        converged = self.status is Status.CONVERGED  # the last state of a failed solver may be arbitrary
        for name in ARRAYS:
            values = getattr(self, name)
            alike = values.ndim == 1 and values.shape == self.rescaled_load.shape and values.size
            words = f"{name} has shape {values.shape}; the arrays of a law have one entry for each load"
            refuse_if(not alike, words)
            values.flags.writeable = False
            possible = np.isfinite(values) if name in SIGNED else values >= 0.0
            check.refuse_entries(name, values, converged & ~possible, "is impossible in a converged law")
        fall = converged and (np.diff(self.rescaled_load) < 0.0).any()
        refuse_if(fall, "the loads of a law must not decrease")

    def __repr__(self) -> str:
        force = "" if self.friction is None else f"friction force {span(self.friction_force, 'N')}, "
        return (
            f"<FrictionLaw: {len(self.area):,} loads {span(self.load, 'N')}, area {span(self.area, 'mm^2')}, "
            f"{force}model {self.model!r}, status {self.status.name.lower()}, {printed_count(self)}>"
        )

    @property
    def load(self) -> FloatArray:
        """Normal load P [N], (k,)."""
        return self.material.composite_modulus * self.rescaled_load

    @property
    def stiffness(self) -> FloatArray:
        """Normal contact stiffness [N/mm], (k,)."""
        return self.material.composite_modulus * self.rescaled_stiffness

    @property
    def rescaled_friction(self) -> FloatArray:
        """Rescaled friction F/(sigma B) = A0 [mm^2], (k,)."""
        return self.area

    @property
    def friction_force(self) -> FloatArray:
        """Friction force ``F = sigma B A0`` [N], (k,); raises InvalidInput without a Friction."""
        if self.friction is None:
            words = "friction_force needs the surface's friction; create the surface with"
            raise InvalidInput(f"{words} friction=metafem.Friction(shear_strength, area_ratio)")
        return self.friction.stress * self.rescaled_friction

    def _force(self) -> FloatArray:
        return self.friction_force

    def quantities(self) -> dict[str, FloatArray]:
        """Return the arrays (k,) of the law by name, in the order of the columns of its tables."""
        found = {name: getattr(self, name) for name in (*ARRAYS, "load", "rescaled_friction", "stiffness")}
        if self.friction is not None:
            found["friction_force"] = self.friction_force
            found["friction_coefficient"] = self.friction_coefficient
        if self.cell is not None:
            found["nominal_pressure"] = self.load / self.cell.area
        if self.friction is not None and self.cell is not None:
            found["nominal_shear_stress"] = self.friction_force / self.cell.area
        return {name: found[name] for name in QUANTITIES if name in found}

    def _about(self) -> dict[str, str]:
        about = {"model": repr(self.model), "status": self.status.name.lower(), "notes": to_lines(self.notes)}
        return about | {"model_error": f"{self.model_error:.2g}, by {self.model_error.source}"}

    def _draw(self, ax: Axes, forces: bool, label: str | None) -> None:
        x, y = (self.load, self.friction_force) if forces else (self.rescaled_load, self.rescaled_friction)
        drawing.law(ax, x, y, forces=forces, label=label)


def friction_law(
    surface: Surface,
    model: Model | None = None,
    *,
    load: ArrayLike | None = None,
    separation: ArrayLike | None = None,
    unloading: bool = False,
) -> FrictionLaw:
    """Return the predicted friction law of a surface.

    Adhesive contacts form and break in jumps at different loads; `unloading` selects the states on unloading.
    All states are stable under load control. The unloading of plastic contacts is not known, and is refused.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        Default: `Independent()`.
    load : array_like, (k,), optional
        Normal loads P [N], at least 0. Adhesive contacts on unloading may also have negative loads, down to
        the load at which the last contacts break.
    separation : array_like, (k,), optional
        Separations [mm]. Default, if neither loads nor separations are given: 100 loads. The largest load
        is that at which the lowest asperity is indented by 0.04 R, the plane reaches the base plane, or the
        approach is 98 % of that at which a contact reaches the largest indentation of its law, whichever
        comes first.
    unloading : bool
        Whether the states are those on unloading from the largest load; default: False. Elastic contacts
        without adhesion have the same law on loading and unloading.

    Returns
    -------
    FrictionLaw
        Law with the states in the order of increasing load.

    Raises
    ------
    InvalidInput
        If both loads and separations are given. For loads that are not finite, negative on loading, or below
        the pull-off load on unloading. For separations that are not finite, and for separations of adhesive
        contacts. For `unloading` if the model or the contact law does not support it, or adhesive contacts
        are open at the largest load.
    NotConverged
        If a residual exceeds the model's tolerance.

    Examples
    --------
    >>> from metafem import Material
    >>> surface = Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=Material(1.36))
    >>> law = friction_law(surface, separation=[0.11, 0.09])
    >>> law.area.round(5)
    array([0.01652, 0.0661 ])
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    solver = checked_model(Independent() if model is None else model)
    refuse_if(load is not None and separation is not None, "only one of load and separation can be given")
    check.instance("unloading", unloading, bool, "True or False")
    law = contact_of(solver).bound(surface)
    words = (
        f"unloading = True: the model {solver.name} has no unloading; use independent, half-space or layer"
    )
    refuse_if(unloading and not getattr(solver, "unloads", False), words)
    values: dict[str, FloatArray]
    if separation is not None:
        words = "cannot be given with adhesive contacts: at a given separation their load falls where they"
        refuse_if(law.adhesive, f"{words} jump into contact; give load", key="separation")
        distance = np.sort(check.array("separation", separation, shape=(None,)))[::-1]
        values = {"approach": surface.height.max() - distance}
    elif load is None:
        values = {"load": default_loads(surface, solver)}
    else:
        newtons = np.sort(check.loads("load", load, negative=unloading and law.adhesive))
        values = {"load": newtons / surface.material.composite_modulus}
    more = {"unloading": True} if unloading else {}  # not all models have this argument
    curve = cast("Any", solver).curve(surface, **values, **more)
    return law_of_curve(surface, solver, curve, values.get("load", curve.load), unloading)


def default_loads(surface: Surface, model: Model) -> FloatArray:
    """Return the rescaled loads of the default grid [mm^2]."""
    contact = contact_of(model).bound(surface)
    lowest, base = int(surface.gap.argmax()), CLEAR * float(surface.height.max())
    touching = surface.gap[lowest] + GRID_INDENTATION * surface.radius[lowest]
    if base > surface.gap[lowest]:
        touching = min(touching, base)
    described = (surface.gap + contact.largest_indentation(contact.summits(surface))).min()
    last = np.array([min(touching, WITHIN * described)])
    end = model.curve(surface, approach=last).load[0]
    if end <= 0.0:  # with adhesion the load may be negative there; use the load without adhesion
        end = with_contact(model, contact.without_adhesion).curve(surface, approach=last).load[0]
    return np.asarray(end * np.arange(1, GRID_POINTS + 1) / GRID_POINTS)


def law_of_curve(
    surface: Surface,
    model: Model,
    curve: Curve,
    rescaled_load: FloatArray,
    unloading: bool = False,
) -> FrictionLaw:
    """Return the friction law of a model's curve; raise NotConverged if the curve has not converged."""
    law = FrictionLaw(
        rescaled_load=np.array(rescaled_load),
        area=curve.area,
        separation=surface.height.max() - curve.approach,
        approach=curve.approach,
        rescaled_stiffness=curve.stiffness,
        residual=curve.residual,
        status=curve.status,
        model=model,
        material=surface.material,
        friction=surface.friction,
        cell=surface.cell,
        **judged(surface, model, curve, curve.notes, unloading),
    )
    if not curve.converged:
        worst = curve.residual.max()
        raise NotConverged(f"{curve.status.value}: largest residual {worst:.2g}; {REMEDY}", law)
    return law
