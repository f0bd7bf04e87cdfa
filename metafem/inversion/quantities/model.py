"""A model of which the areas are another quantity of a surface."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.models import Independent, Model
from metafem.models.curve import Curve, Sensitivity, areas_one_by_one
from metafem.models.interacting.model import Interacting
from metafem.prediction.quantities.tangential import contact_radii
from metafem.surface import Surface


@dataclass(frozen=True)
class QuantityModel:
    """A model of which the areas of all curves are a quantity of the surface under another model [mm].

    Its contacts have the quantity as their area without interaction. The sensitivities are those of
    `gradient_model`: of this model if `model` is `Interacting`.

    model: model of the user. contact: law of one contact whose area is the quantity. of: the quantity.
    factor: tangential stiffness divided by the sum of the contact radii [-]; not used for others.
    """

    couples: ClassVar[bool] = True

    model: Model
    contact: Contact
    of: str
    factor: float

    @property
    def name(self) -> str:
        """Name of the model."""
        return self.model.name

    @property
    def gradient_model(self) -> QuantityModel:
        """The model with the sensitivities: this one, or the same quantity under another model."""
        return replace(self, model=self.model.gradient_model)

    @property
    def ignores_open(self) -> bool:
        """Whether the positions of open asperities have no effect."""
        return self.model.couples

    @property
    def reference(self) -> Interacting:
        """The model with interaction for comparison."""
        return self.model.reference

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Return equilibria, with the quantity as their area, at increasing rescaled loads [mm^2], (k,)."""
        found = self.model.curve(surface, load, approach=approach)
        if self.of == "stiffness":
            values = found.stiffness
        elif self.of == "conductance":
            values = cast("Any", self.model).conductance(surface, found.load)
        else:
            values = self.factor * contact_radii(self.model, surface, found.load).sum(axis=1)
        return replace(found, area=values, friction_area=None, compute_last=lambda: found.last)

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None, by: str = "height"
    ) -> Sensitivity:
        """Return the curve of the quantity at increasing loads (k,), and its derivatives by the heights."""
        model: Any = self.model
        if model.couples:
            of = "contact_radius" if self.of == "tangential_stiffness" else self.of
            found = model.quantity_sensitivity(surface, load, of, height)
            factor = self.factor if self.of == "tangential_stiffness" else 1.0
            curve = replace(
                found.curve, area=factor * found.curve.area, compute_last=lambda: found.curve.last
            )
            return Sensitivity(curve, lambda: factor * found.gradient, found.indentation)
        return Independent(self.contact).sensitivity(surface, load, height)

    def areas(
        self,
        surface: Surface,
        load: FloatArray,
        height: FloatArray,
        radius: FloatArray | None = None,
        position: FloatArray | None = None,
    ) -> FloatArray:
        """Return the quantity [mm] of many surfaces at increasing rescaled loads (k,), (m, k)."""
        return areas_one_by_one(self.curve, surface, load, height, radius, position)
