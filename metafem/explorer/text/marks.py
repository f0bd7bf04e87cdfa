"""Common base of the handles of all kinds of targets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document
from metafem.explorer.text.shape import Shape
from metafem.explorer.text.written import rounded, stated
from metafem.files import Specification
from metafem.inversion import Design, Target


@dataclass(frozen=True)
class Handle:
    """A point of the plot that the user can drag.

    Attributes
    ----------
    id : str
    load, friction : float
        Rescaled load and friction at which the handle is drawn [mm^2].
    moves : str
        Directions in which the handle moves: "xy", "x" or "y".
    label : str
        The parameter that the handle changes, in words.
    carried : str
        What is written beside the handle, such as its friction coefficient; "" for nothing.
    """

    id: str
    load: float
    friction: float
    moves: str
    label: str
    carried: str = ""


@dataclass(frozen=True, eq=False)
class Scene:
    """The text of a specification, the specification itself, and the last design."""

    document: Document
    specification: Specification
    design: Design | None

    @property
    def target(self) -> Target:
        """The target of the specification."""
        return self.specification.target

    @cached_property
    def section(self) -> Mapping[str, Any]:
        """The keys and values of the target in the text."""
        section = self.document.value("target")
        return section if isinstance(section, dict) else {}

    @property
    def kind(self) -> str:
        """The kind of the target."""
        return str(self.section.get("kind"))

    @property
    def load_stress(self) -> float:
        """Force per rescaled load [MPa]: E*."""
        return self.specification.template.material.composite_modulus

    @property
    def friction_stress(self) -> float | None:
        """Force per rescaled friction [MPa]: sigma B; None without a friction."""
        friction = self.specification.template.friction
        return None if friction is None else friction.stress

    def load(self, rescaled: float, like: str, resolution: float) -> str:
        """Return a rescaled load [mm^2] as a quantity in the unit of the quantity `like`."""
        return stated(rescaled, like, self.load_stress, resolution)

    def friction(self, rescaled: float, like: str, resolution: float) -> str:
        """Return a rescaled friction [mm^2] as a quantity in the unit of the quantity `like`."""
        return stated(rescaled, like, self.friction_stress, resolution)

    def slope(self, slope: float, resolution: float) -> float:
        """Return a slope in the form of the text, as a slope or as a friction coefficient."""
        return rounded(self.target.wording.coefficient(slope), resolution)

    def achieved(self, rescaled_load: FloatArray) -> FloatArray | None:
        """Return the rescaled friction of the last design at rescaled loads [mm^2]; None without a design.

        Outside the load range of the design's law, the friction is proportional to the load.
        """
        if self.design is None:
            return None
        law = self.design.law
        load, friction = law.rescaled_load, law.rescaled_friction
        inside = np.clip(rescaled_load, load[0], load[-1])
        return np.asarray(np.interp(inside, load, friction) * rescaled_load / inside)

    def written(self, values: Mapping[str, Any]) -> str:
        """Return the text with new values for keys of the target."""
        return self.document.with_values({f"target.{name}": value for name, value in values.items()})


class Marks:
    """Base class for the handles of one kind of target."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    def handles(self) -> tuple[Handle, ...]:
        """Return the handles."""
        raise NotImplementedError

    def shape(self) -> Shape:
        """Return the curve of the target, and the points that follow each handle."""
        raise NotImplementedError

    def moved(self, handle: Handle, load: float, friction: float, resolution: float) -> dict[str, Any]:
        """Return the keys of the target that change when a handle has moved."""
        raise NotImplementedError

    def added(self, load: float, friction: float, resolution: float) -> dict[str, Any]:
        """Return the keys of the target that change when a point is added."""
        raise InvalidInput(
            f"a {self.scene.kind} law is not given by points; choose the kind operating-points or sampled to "
            "add some"
        )

    def removed(self, id: str) -> dict[str, Any]:
        """Return the keys of the target that change when the point or parameter of a handle is removed."""
        raise InvalidInput(f"a {self.scene.kind} law needs what this handle changes; it cannot be removed")
