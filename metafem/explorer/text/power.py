"""Handles of power laws."""

from __future__ import annotations

import math
from functools import cached_property

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.text.marks import Handle, Numbers, Scene
from metafem.explorer.text.written import rounded


class PowerHandles(Scene):
    """Handles for the exponent, the prefactor and the ends of the range.

    The handle of the exponent lies halfway between the middle and the upper end of the range; both midpoints
    are taken in the logarithm of the load. Dragging this handle turns the law about the middle.
    """

    def handles(self) -> tuple[Handle, ...]:
        """Return the handles for the exponent, for the prefactor if the target has one, and for the ends."""
        target, middle, (low, high) = self.target, self._middle, self.target.load_range
        found = [("exponent", math.sqrt(middle * high), "y", f"exponent {target.exponent:.4g}")]
        if target.prefactor is not None:
            found.append(("prefactor", middle, "y", f"prefactor {target.prefactor:.4g}"))
        found.append(("range-low", low, "x", "smallest load of the range"))
        found.append(("range-high", high, "x", "largest load of the range"))
        return tuple(Handle(id, load, self._friction(load), *rest) for id, load, *rest in found)

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return the curve."""
        load = self.target.curve().load
        return load, self._prefactor * load**self.target.exponent

    def moved(self, handle: Handle, load: float, friction: float, resolution: float) -> tuple[Numbers, float]:
        """Return the numbers that change when a handle has moved, and their resolution."""
        if handle.moves == "x":
            return self.slid(handle, load, resolution)
        friction = max(friction, resolution * handle.friction)
        try:
            return self._risen(handle, load, friction, resolution), resolution
        except ArithmeticError:  # a power overflows double precision, or the range has no middle
            words = "the law cannot be moved by hand over this range of loads; change the keys of [target]"
            raise InvalidInput(f"target.load_range: {words}") from None

    def _risen(self, handle: Handle, load: float, friction: float, resolution: float) -> Numbers:
        """Return the numbers that change so that the law has this friction at this load."""
        target, middle = self.target, self._middle
        if handle.id == "prefactor":
            return {"prefactor": friction / middle**target.exponent}
        level, load = self._friction(middle), load if load > middle else handle.load
        exponent = math.log(friction / level) / math.log(load / middle)
        exponent = rounded(max(exponent, resolution), resolution)
        if target.prefactor is None:
            return {"exponent": exponent}
        return {"exponent": exponent, "prefactor": level / middle**exponent}

    def removed(self, id: str) -> Numbers:
        """Return the numbers that change when the prefactor is removed, which the design then chooses."""
        return {"prefactor": None} if id == "prefactor" else super().removed(id)

    @property
    def _middle(self) -> float:
        """The middle of the range in the logarithm of the load [mm^2]."""
        return math.sqrt(math.prod(self.target.load_range))

    @cached_property
    def _prefactor(self) -> float:
        """The prefactor; if the target leaves it open, the prefactor of the last design."""
        target = self.target
        if target.prefactor is not None:
            return float(target.prefactor)
        law = target.curve()
        achieved = self.achieved(law.load)
        return 1.0 if achieved is None else float(law.law(achieved)[0] / law.free[0, 0])

    def _friction(self, load: float) -> float:
        """Return the rescaled friction of the law at a rescaled load [mm^2]."""
        return float(self._prefactor * load**self.target.exponent)
