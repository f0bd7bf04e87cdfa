"""Common base of interacting asperities with and without adhesion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.pedestal import TALLEST, pedestal_influence
from metafem.errors import refuse_if
from metafem.models.curve import RescaledState
from metafem.notes import Note, information
from metafem.substrate import Substrate
from metafem.surface import Surface

# The convention of the separation for periodic cells on a half-space.
MEAN_PLANE = information(
    "the separation is measured from the mean plane of the deformed periodic surface: the mean displacement "
    "of a half-space diverges and is left out"
)


def refuse_wide(surface: Surface, contact_radius: float) -> None:
    """Raise InvalidInput if a contact radius [mm] exceeds half of the shorter side of a periodic cell."""
    if surface.cell is None:
        return
    side = min(surface.cell.width, surface.cell.length)
    refuse_if(
        2.0 * contact_radius > side,
        f"a contact of radius {contact_radius:.4g} mm is wider than the periodic cell of {side:g} mm; use "
        "lighter loads or a larger cell",
    )


@dataclass(frozen=True)
class Coupled:
    """Asperities of one surface with their contact law, substrate and order."""

    model: Any  # to which the states refer
    surface: Surface
    law: Contact  # for unit E*
    substrate: Substrate  # with the thickness and the material of the surface
    order: int
    pedestal: bool

    def pedestals(self, height: FloatArray, radius: FloatArray) -> FloatArray | float:
        """Return the displacement of each summit by the compliance of its cap, per unit of P/E* [1/mm]."""
        return pedestal_influence(height, radius)[0] if self.pedestal else 0.0

    def on_pedestals(self, gradient: FloatArray, height: FloatArray, load: FloatArray) -> FloatArray:
        """Return dA0/dh (k, n) [mm] with the change of the caps' compliance, at loads (k, n) [mm^2]."""
        if not self.pedestal:
            return gradient
        return gradient * (1.0 - pedestal_influence(height, self.surface.radius)[1] * load)

    def state(
        self,
        height: FloatArray,
        load: FloatArray,
        area: FloatArray,
        indentation: FloatArray,
        notes: tuple[Note, ...] = (),
    ) -> RescaledState:
        """Return the state of asperities (n,)."""
        # the foot of a cap sinks with its summit, while the adjacent base hardly sinks; the shift of a
        # contact adds less than a micrometre to the base gap
        base = height - indentation - self.pedestals(height, self.surface.radius) * load
        tall = int((self.surface.height > TALLEST * self.surface.radius).sum())
        if self.pedestal and tall:
            text = f"{tall} summits are higher than {TALLEST:g} R; their pedestals are taken as that high"
            most = float((self.surface.height / self.surface.radius).max())
            notes += (
                Note(
                    text,
                    quantity="height of a summit over its radius",
                    value=most,
                    bound=TALLEST,
                    remedies=("radius",),
                ),
            )
        if self.surface.cell is not None and not hasattr(self.substrate, "thickness"):
            notes += (MEAN_PLANE,)
        return RescaledState(load, area, indentation, float(base.min()), self.model, notes)
