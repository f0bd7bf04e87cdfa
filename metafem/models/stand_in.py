"""Attributes that several models share: the models that stand in for them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Self, cast

from metafem._validate import FloatArray
from metafem.models.model import Model, areas_one_by_one
from metafem.substrate import HalfSpace, Substrate
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.models.interacting.model import Interacting


class Uncoupled:
    """A model of asperities that do not interact, with sensitivities of its own."""

    couples: ClassVar[bool] = False

    @property
    def gradient_model(self) -> Self:
        """The model itself."""
        return self

    @property
    def reference(self) -> Interacting:
        """Order 3 on the half-space."""
        from metafem.models.interacting.model import Interacting

        return Interacting()


class WithoutGradients:
    """A coupled model on a substrate, for whose sensitivities those of `Interacting` are used."""

    couples: ClassVar[bool] = True
    title: ClassVar[str]
    substrate: Substrate

    @property
    def name(self) -> str:
        """Name of the model in texts; it includes a substrate other than the half-space."""
        on = "" if self.substrate == HalfSpace() else f", {self.gradient_model.name}"
        return f"{self.title}{on}"

    @cached_property
    def gradient_model(self) -> Interacting:
        """`Interacting` of order 3 on the same substrate."""
        from metafem.models.interacting.model import Interacting

        return Interacting(substrate=self.substrate)

    @property
    def reference(self) -> Interacting:
        """`Interacting` of order 3 on the same substrate."""
        return self.gradient_model

    def areas(
        self,
        surface: Surface,
        load: FloatArray,
        height: FloatArray,
        radius: FloatArray | None = None,
        position: FloatArray | None = None,
    ) -> FloatArray:
        """A0 [mm^2] at increasing rescaled loads (k,) for many surfaces, (m, k); see `Model.areas`."""
        return areas_one_by_one(cast(Model, self), surface, load, height, radius, position)
