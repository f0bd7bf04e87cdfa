"""Attributes that several models share: the models that stand in for them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Self, cast

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.models.model import PARABOLOID, Model, areas_one_by_one
from metafem.substrate import HalfSpace, Substrate
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.models.interacting.model import Interacting


class Uncoupled:
    """A model of asperities that do not interact, with sensitivities of its own."""

    couples: ClassVar[bool] = False
    contact: Contact

    @property
    def gradient_model(self) -> Self:
        """The model itself."""
        return self

    @property
    def reference(self) -> Interacting:
        """Interacting contacts of the same law on the half-space, of order 3 if the law has one."""
        from metafem.models.interacting.model import Interacting

        return Interacting(self.contact.largest_order, contact=self.contact)


class WithoutGradients:
    """A coupled model on a substrate, for whose sensitivities those of `Interacting` are used."""

    couples: ClassVar[bool] = True
    title: ClassVar[str]
    substrate: Substrate
    contact: Contact

    @property
    def name(self) -> str:
        """Name of the model in texts; it includes a substrate other than the half-space, and the law."""
        parts = [self.title]
        if self.substrate != HalfSpace():
            # a user's substrate may have no name
            parts.append(getattr(self.substrate, "name", type(self.substrate).__name__))
        if self.contact != PARABOLOID:
            parts.append(repr(self.contact))
        return ", ".join(parts)

    @cached_property
    def gradient_model(self) -> Interacting:
        """`Interacting` contacts of the same law on the same substrate, of order 3 if the law has one."""
        from metafem.models.interacting.model import Interacting

        return Interacting(self.contact.largest_order, self.substrate, self.contact)

    @property
    def reference(self) -> Interacting:
        """That model."""
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
