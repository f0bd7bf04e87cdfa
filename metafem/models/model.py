"""The protocol of all models, and the code that several of them share."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, cast, runtime_checkable

from metafem._given import shown
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID as PARABOLOID
from metafem.contact.law import checked_contact as checked_contact
from metafem.errors import InvalidInput
from metafem.models.curve import Curve, Sensitivity, areas_one_by_one
from metafem.models.interacting.model import Interacting
from metafem.substrate import HalfSpace, Substrate
from metafem.surface import Surface


def checked_model(model: object) -> Model:
    """Return a model, or raise InvalidInput for anything else."""
    if isinstance(model, type) or not hasattr(model, "curve"):
        raise InvalidInput(
            f"model = {shown(model)} must be a model such as metafem.Independent(); loads go by load="
        )
    return cast("Model", model)


def contact_of(model: Model) -> Contact:
    """Return the contact law of a model; Hertz's for a user-defined model without the attribute."""
    return cast("Contact", getattr(model, "contact", PARABOLOID))


def with_contact(model: Model, contact: Contact) -> Model:
    """Return a model with another contact law; raises InvalidInput, with its name, for an unsuitable law.

    A law given only as load and area over the indentation is coupled by order 1.
    """
    if contact == contact_of(model):
        return model
    value: Any = model
    members = {field.name for field in fields(value)}
    if "contact" not in members:
        raise InvalidInput(f"{model.name}: the contacts of this model are paraboloids, not {contact!r}")
    try:
        order = {"order": min(value.order, contact.largest_order)} if "order" in members else {}
        return cast("Model", replace(value, contact=contact, **order))
    except InvalidInput as error:
        raise InvalidInput(f"{model.name}: {error}") from None


def has_paraboloids(model: Model) -> bool:
    """Whether the contacts of a model are Hertz's."""
    return contact_of(model) == PARABOLOID


@runtime_checkable
class Model(Protocol):
    """A frozen value that turns a surface and loads into equilibria."""

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``."""
        ...

    @property
    def couples(self) -> bool:
        """Whether contacts interact, so that A0(P) depends on the sites."""
        ...

    @property
    def gradient_model(self) -> Sensitive:
        """Model that supplies the sensitivities for an inversion: this model if it has sensitivities."""
        ...

    @property
    def reference(self) -> Interacting:
        """Model with which this one is compared: `Interacting` of order 3 on its substrate."""
        ...

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,)."""
        ...

    def areas(
        self,
        surface: Surface,
        load: FloatArray,
        height: FloatArray,
        radius: FloatArray | None = None,
        position: FloatArray | None = None,
    ) -> FloatArray:
        """A0 [mm^2] at increasing rescaled loads (k,) for many surfaces, (m, k); nan if not converged.

        height, radius: (m, n) [mm]; position: (m, n, 2) [mm]; default: those of the surface.
        """
        ...


class Sensitive(Model, Protocol):
    """A model with the derivatives of its law by the heights."""

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads P/E* (k,), with dA0/dh of each height at fixed load.

        height: summit heights (n,) [mm] that replace those of the surface; they are not checked.
        """
        ...


class WithoutGradients:
    """A coupled model on a substrate; the sensitivities of `Interacting` are used in place of its own."""

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
        return Interacting(self.contact.largest_order, self.substrate, self.contact)

    @property
    def reference(self) -> Interacting:
        """The gradient model."""
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
        return areas_one_by_one(cast("Model", self).curve, surface, load, height, radius, position)
