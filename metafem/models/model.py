"""The protocol of all models, and code that several models share."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cached_property
from typing import Any, ClassVar, Protocol, cast, runtime_checkable

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID as PARABOLOID
from metafem.contact.law import checked_contact as checked_contact
from metafem.errors import InvalidInput, shown
from metafem.models.curve import Curve, areas_one_by_one
from metafem.models.independent import Independent
from metafem.models.interacting.model import Interacting
from metafem.substrate import HalfSpace, Substrate
from metafem.surface import Surface


def checked_model(model: object) -> Model:
    """Return `model`, or raise InvalidInput if it is not a model."""
    if isinstance(model, type) or not hasattr(model, "curve"):
        raise InvalidInput(
            f"model = {shown(model)} must be a model such as metafem.Independent(); loads go by load="
        )
    return cast("Model", model)


def contact_of(model: Model) -> Contact:
    """Return the contact law of a model; Hertz's law for a user-defined model without `contact`."""
    return cast("Contact", getattr(model, "contact", PARABOLOID))


def with_contact(model: Model, contact: Contact) -> Model:
    """Return a model with another contact law; raise InvalidInput if the model cannot use it.

    If the law consists only of load and area as functions of the indentation, the order becomes 1.
    """
    if contact == contact_of(model):
        return model
    value: Any = model
    members = {field.name for field in fields(value)}
    if "contact" not in members:
        raise InvalidInput(f"{model.name}: the contacts of this model are paraboloids, not {contact}")
    try:
        order = {"order": min(value.order, contact.largest_order)} if "order" in members else {}
        return cast("Model", replace(value, contact=contact, **order))
    except InvalidInput as error:
        raise InvalidInput(f"{model.name}: {error}") from None


def has_paraboloids(model: Model) -> bool:
    """Return whether a model uses Hertz's law."""
    return contact_of(model) == PARABOLOID


# Models that compute derivatives of the friction law with respect to the heights.
Sensitive = Independent | Interacting


@runtime_checkable
class Model(Protocol):
    """A model computes the equilibria of a surface at given loads or approaches; models are frozen values."""

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``."""

    @property
    def couples(self) -> bool:
        """Whether the contacts interact, so that A0(P) depends on their positions."""

    @property
    def gradient_model(self) -> Sensitive:
        """Model whose sensitivities an inversion uses: this model if it has sensitivities."""

    @property
    def reference(self) -> Interacting:
        """Model for comparison: `Interacting` on the same substrate, of the highest order of the law."""

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Return equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,)."""

    def areas(
        self, surface: Surface, load: FloatArray, height: FloatArray, radius: Any = None, position: Any = None
    ) -> FloatArray:
        """Return A0 [mm^2] of many surfaces at increasing rescaled loads (k,), (m, k); nan if not converged.

        height, radius: (m, n) [mm]; position: (m, n, 2) [mm]; default: the surface's.
        """


class WithoutGradients:
    """Base of coupled models without sensitivities; inversions use the sensitivities of `Interacting`."""

    couples: ClassVar[bool] = True
    title: ClassVar[str]
    substrate: Substrate
    contact: Contact

    @property
    def name(self) -> str:
        """Name of the model in texts, with its substrate and its law unless they are the default ones."""
        parts = [self.title]
        if self.substrate != HalfSpace():
            # a user's substrate may have no name
            parts.append(getattr(self.substrate, "name", type(self.substrate).__name__))
        if self.contact != PARABOLOID:
            parts.append(str(self.contact))
        return ", ".join(parts)

    @cached_property
    def gradient_model(self) -> Interacting:
        """`Interacting` with the same law and substrate, of the highest order that the law supports."""
        return Interacting(self.contact.largest_order, self.substrate, self.contact)

    @property
    def reference(self) -> Interacting:
        """The gradient model."""
        return self.gradient_model

    def areas(
        self, surface: Surface, load: FloatArray, height: FloatArray, radius: Any = None, position: Any = None
    ) -> FloatArray:
        """Return A0 [mm^2] of many surfaces at increasing rescaled loads (k,), (m, k); see `Model.areas`."""
        return areas_one_by_one(cast("Model", self).curve, surface, load, height, radius, position)
