"""Handles of targets that are given by parameters: straight lines and power laws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.fields import rounded
from metafem.explorer.scene import Handle, Numbers, Scene

# Estimate of the largest rescaled load of a surface before there is a design, as a fraction of
# "number of sites x largest height x radius". It is near the largest loads of the paper's surfaces.
BEFORE_ANY_DESIGN = 0.1

# Smallest load difference between pointer and pivot at which a branch is turned through the pointer, as a
# fraction of the load difference between handle and pivot. Closer to the pivot, a small move would change the
# slope far too much.
NEAREST = 0.2


@dataclass(frozen=True)
class Branch:
    """A straight branch of a target as the plot draws it.

    Attributes
    ----------
    slope : float
    at, friction : float
        Rescaled load and friction of the handle [mm^2].
    pivot : float
        Rescaled load of the point about which the handle turns the branch [mm^2].
    low, high : float
        Rescaled loads between which the branch is drawn [mm^2].
    """

    slope: float
    at: float
    friction: float
    pivot: float
    low: float
    high: float

    def friction_at(self, load: float) -> float:
        """Return the rescaled friction of the branch at a rescaled load [mm^2]."""
        return self.friction + self.slope * (load - self.at)

    def slope_through(self, load: float, friction: float) -> float:
        """Return the slope of the branch after its handle has moved to a load and friction [mm^2]."""
        near = (load - self.pivot) / (self.at - self.pivot) < NEAREST
        run = (self.at if near else load) - self.pivot
        return (friction - self.friction_at(self.pivot)) / run


class LineHandles(Scene):
    """Handles for the slopes, crossover loads and range ends of linear, bilinear and multilinear laws.

    The handle of a slope is at the middle of its branch. The first branch turns about its intercept, which is
    0 for lines through the origin and otherwise the intercept of the design. Each other branch turns about
    the crossover at its start.
    """

    def handles(self) -> tuple[Handle, ...]:
        """Return a handle for each slope, each crossover load and each end of the range."""
        found = []
        for i, branch in enumerate(self.branches):
            words = self.target.wording.slopes(branch.slope)
            label = f"{words}, branch {i + 1}" if len(self.branches) > 1 else words
            carried = words.replace("friction coefficient", "μ =").replace("slope ", "slope = ")
            found.append(Handle(f"slope-{i}", branch.at, branch.friction, "y", label, carried))
        for id, load, label in self.path:
            ranged = bool(self.target.branches)
            friction = self._friction(load) if ranged else self.branches[0].friction_at(load)
            found.append(Handle(id, load, friction, "x", label))
        return tuple(found)

    def moved(self, handle: Handle, load: float, friction: float, resolution: float) -> tuple[Numbers, float]:
        """Return the numbers that change when a handle has moved, and their resolution."""
        if handle.moves == "y":
            i, slopes = int(handle.id.removeprefix("slope-")), [*self.slopes]
            slopes[i] = max(self.branches[i].slope_through(load, friction), resolution * slopes[i])
            several = hasattr(self.target, "slopes")
            return {"slopes": slopes} if several else {"slope": slopes[0]}, resolution
        return self.slid(handle, load, resolution)

    def removed(self, id: str) -> Numbers:
        """Return the numbers that change when the load range is removed, if the law does not require it."""
        if id.startswith("range-") and self.kind != "multilinear":
            return {"load_range": None}
        return super().removed(id)

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return the curve of the branches, with the intercepts that are closest to the last design."""
        corners: list[tuple[float, float]] = []
        for branch in self.branches:
            if not corners or branch.low > corners[-1][0]:
                if corners and not self.target.branches:
                    corners.append((np.nan, np.nan))  # branches without a load range need not meet
                corners.append((branch.low, branch.friction_at(branch.low)))
            corners.append((branch.high, branch.friction_at(branch.high)))
        load, friction = np.array(corners).T
        return load, friction

    @property
    def slopes(self) -> tuple[float, ...]:
        """The slopes of the branches."""
        target = self.target
        return tuple(target.slopes) if hasattr(target, "slopes") else (target.slope,)

    @cached_property
    def branches(self) -> list[Branch]:
        """The branches, with the intercepts of the last design."""
        target, found = self.target, list[Branch]()
        for i, slope in enumerate(self.slopes):
            if target.branches:
                low, high = target.branches[i][1]
                pivot, at = (low if i else 0.0), 0.5 * (low + high)
                friction = self._friction(at)
            else:
                pivot = target.lines[i][1] if i else 0.0
                at, friction = self._of_density(i, slope)
                low, high = self._fits[i][0].load_range if self._fits else (pivot, 2.0 * at - pivot)
            found.append(Branch(slope, at, friction, pivot, low, high))
        return found

    @property
    def path(self) -> list[tuple[str, float, str]]:
        """Handle id, rescaled load [mm^2] and label of all crossovers and range ends, by load."""
        target = self.target
        crossover = getattr(target, "crossover_load", None)
        pairs = getattr(target, "crossover_loads", () if crossover is None else ((crossover, crossover),))
        found = []
        for i, (end, start) in enumerate(pairs):
            words = "crossover load" if len(pairs) == 1 else f"crossover load {i + 1}"
            if end == start:
                found.append((f"crossover-{i}", end, words))
            else:
                found.append((f"crossover-{i}-end", end, f"{words}, end of branch {i + 1}"))
                found.append((f"crossover-{i}-start", start, f"{words}, start of branch {i + 2}"))
        if target.load_range is None:
            return found
        low, high = target.load_range
        first, last = "smallest load of the range", "largest load of the range"
        return [("range-low", low, first), *found, ("range-high", high, last)]

    @property
    def _fits(self) -> Any:
        """The fits of the last design to the branches; none if it has another number of branches."""
        design = self.design
        return design.fits if design is not None and len(design.fits) == len(self.slopes) else ()

    def _friction(self, load: float) -> float:
        """Return the rescaled friction of a target with a load range at a rescaled load [mm^2]."""
        return float(np.interp(load, *self._law))

    @cached_property
    def _law(self) -> tuple[FloatArray, FloatArray]:
        """Rescaled loads and frictions [mm^2] of a target with a load range.

        The intercepts that the target leaves open are those closest to the last design.
        """
        law = self.target.curve()
        if not law.is_open:
            return law.load, law.middle
        achieved = self.achieved(law.load)
        return law.load, law.law(law.load * max(self.slopes) if achieved is None else achieved)

    def _of_density(self, i: int, slope: float) -> tuple[float, float]:
        """Return the rescaled load and friction of the slope handle of a branch without a range [mm^2]."""
        if not self._fits:
            template, limits = self.specification.template, self.specification.limits
            scale = template.count * limits.max_height * float(template.radius.mean())
            crossover = getattr(self.target, "crossover_load", 0.0)
            load = (0.5 * (crossover or BEFORE_ANY_DESIGN * scale), 1.5 * crossover)[i]
            return load, slope * load + (self.slopes[0] - slope) * crossover * i
        branch, fit = self._fits[i]
        middle = 0.5 * (branch.load_range[0] + branch.load_range[1])
        if branch.intercept is not None:
            return middle, branch.intercept + slope * middle
        pivot = self.target.lines[i][1]
        return middle, fit.intercept + fit.slope * middle + (slope - branch.slope) * (middle - pivot)


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
