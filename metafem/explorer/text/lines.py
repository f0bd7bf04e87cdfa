"""Handles of targets that consist of straight lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.explorer.text.marks import Handle, Marks
from metafem.explorer.text.shape import Branch, Point, Shape, shape_of
from metafem.explorer.text.written import between

# Estimate of the largest rescaled load of a surface before there is a design, as a fraction of
# "number of sites x largest height x radius". It is near the largest loads of the paper's surfaces.
BEFORE_ANY_DESIGN = 0.1

# Smallest load difference between pointer and pivot at which a line is turned through the pointer, as a
# fraction of the load difference between handle and pivot. Closer to the pivot, a small move would change the
# slope far too much.
NEAREST = 0.2


@dataclass(frozen=True)
class Line:
    """A branch of a target: its slope, and the load and friction of its handle and of its pivot [mm^2]."""

    slope: float
    load: float
    friction: float
    pivot: tuple[float, float]

    def turned(self, load: float, friction: float) -> float:
        """Return the slope of the line after its handle has moved to a load and friction [mm^2]."""
        run = load - self.pivot[0]
        if run < NEAREST * (self.load - self.pivot[0]):
            run = self.load - self.pivot[0]
        return (friction - self.pivot[1]) / run


class LineHandles(Marks):
    """Handles for the slopes, crossover loads and range ends of linear, bilinear and multilinear laws.

    The handle of a slope is at the middle of its branch. The first line turns about its intercept, which is 0
    for lines through the origin and otherwise the intercept of the design. Each other line turns about the
    crossover at its start.
    """

    def handles(self) -> tuple[Handle, ...]:
        """Return a handle for each slope, each crossover load and each end of the range."""
        scene, found = self.scene, []
        several = len(self.lines) > 1
        for i, line in enumerate(self.lines):
            words = scene.target.wording.slopes(line.slope)
            label = f"{words}, branch {i + 1}" if several else words
            carried = words.replace("friction coefficient", "μ =").replace("slope ", "slope = ")
            found.append(Handle(f"slope-{i}", line.load, line.friction, "y", label, carried))
        for id, load, label in self.path:
            found.append(Handle(id, load, self._friction(load), "x", label))
        return tuple(found)

    def moved(self, handle: Handle, load: float, friction: float, resolution: float) -> dict[str, Any]:
        """Return the keys that change when a handle has moved."""
        name, _, number = handle.id.partition("-")
        if name == "slope":
            return self._turned(int(number), load, friction, resolution)
        path = [place for place, _, _ in self.path]
        i, loads = path.index(handle.id), [place[1] for place in self.path]
        low = loads[i - 1] if i else 0.0
        high = loads[i + 1] if i + 1 < len(loads) else float("inf")
        placed, fine = between(load, low, high, resolution)
        placed = placed or resolution * handle.load
        return self._at(handle.id, placed, fine)

    def removed(self, id: str) -> dict[str, Any]:
        """Return the keys that change when the load range is removed, if the law does not require it."""
        if id.startswith("range-") and self.scene.kind != "multilinear":
            return {"load_range": None}
        return super().removed(id)

    def shape(self) -> Shape:
        """Return the curve of the branches, with the intercepts that are closest to the last design."""
        path = {id: Point(self._branch_of(id), load) for id, load, _ in self.path}
        return shape_of(self._branches(), path)

    def _branches(self) -> list[Branch]:
        target, design, found = self.scene.target, self.scene.design, list[Branch]()
        for i, line in enumerate(self.lines):
            pivot = line.pivot[0]
            low, high = pivot, 2.0 * line.load - pivot
            if target.branches:
                low, high = target.branches[i][1]
            elif design is not None and len(design.fits) == len(self.slopes):
                low, high = design.fits[i][0].load_range
            centred = bool(target.branches)
            joined = i > 0 and (not centred or low == found[-1].high)
            given = (line.slope, line.load, line.friction, pivot, low, high, joined, centred)
            found.append(Branch(*given))
        return found

    def _branch_of(self, id: str) -> int:
        """Return the number of the branch whose end the handle `id` of the path moves."""
        if id.startswith("range-"):
            return 0 if id == "range-low" else len(self.slopes) - 1
        _, number, *end = id.split("-")
        return int(number) + (end == ["start"])

    @property
    def slopes(self) -> tuple[float, ...]:
        """The slopes of the branches."""
        target: Any = self.scene.target
        return tuple(target.slopes) if hasattr(target, "slopes") else (target.slope,)

    @property
    def lines(self) -> list[Line]:
        """The branches, with the intercepts of the last design."""
        target, found = self.scene.target, []
        starts = [low for _, (low, _) in target.branches] or [low for _, low in target.lines]
        for i, (slope, start) in enumerate(zip(self.slopes, starts, strict=True)):
            if target.branches:
                low, high = target.branches[i][1]
                load = 0.5 * (low + high)
                friction = float(self._drawn(np.array([load]))[0])
            else:
                load, friction = self._of_density(i, slope)
            pivot = start if i else 0.0
            found.append(Line(slope, load, friction, (pivot, friction - slope * (load - pivot))))
        return found

    @property
    def path(self) -> list[tuple[str, float, str]]:
        """Handle id, rescaled load [mm^2] and label of all crossover loads and range ends, by load."""
        target: Any = self.scene.target
        pairs = getattr(target, "crossover_loads", ())
        if hasattr(target, "crossover_load"):
            pairs = ((target.crossover_load,) * 2,)
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
        return [
            ("range-low", low, "smallest load of the range"),
            *found,
            ("range-high", high, "largest load of the range"),
        ]

    def _friction(self, load: float) -> float:
        """Return the rescaled friction of the target at the load of a handle of the path [mm^2]."""
        target = self.scene.target
        if target.branches:
            return float(self._drawn(np.array([load]))[0])
        line = self.lines[0]
        return line.friction + line.slope * (load - line.load)

    def _drawn(self, load: FloatArray) -> FloatArray:
        """Return the rescaled friction of a target with a load range at rescaled loads [mm^2].

        The intercepts that the target leaves open are those closest to the last design.
        """
        law = self.scene.target.curve()
        friction = law.base
        if law.is_open:
            achieved = self.scene.achieved(law.load)
            friction = law.law(law.load * max(self.slopes) if achieved is None else achieved)
        return np.asarray(np.interp(load, law.load, friction))

    def _of_density(self, i: int, slope: float) -> tuple[float, float]:
        """Return the rescaled load and friction of the slope handle of a line without a range [mm^2]."""
        design = self.scene.design
        if design is None or len(design.fits) != len(self.slopes):
            template, limits = self.scene.specification.template, self.scene.specification.limits
            scale = template.count * limits.max_height * float(template.radius.mean())
            crossover = getattr(self.scene.target, "crossover_load", 0.0)
            load = (0.5 * (crossover or BEFORE_ANY_DESIGN * scale), 1.5 * crossover)[i]
            return load, slope * load + (self.slopes[0] - slope) * crossover * i
        branch, fit = design.fits[i]
        middle = 0.5 * (branch.load_range[0] + branch.load_range[1])
        if branch.intercept is not None:
            return middle, branch.intercept + slope * middle
        pivot = self.scene.target.lines[i][1]
        return middle, fit.intercept + fit.slope * middle + (slope - branch.slope) * (middle - pivot)

    def _turned(self, i: int, load: float, friction: float, resolution: float) -> dict[str, Any]:
        """Return the keys that change when the slope handle of line `i` has moved, with a positive slope."""
        line = self.lines[i]
        value = self.scene.slope(max(line.turned(load, friction), resolution * line.slope), resolution)
        section = self.scene.section
        single = next((name for name in ("slope", "friction_coefficient") if name in section), None)
        if single is not None:
            return {single: value}
        name = "slopes" if "slopes" in section else "friction_coefficients"
        return {name: [value if j == i else other for j, other in enumerate(section[name])]}

    def _at(self, id: str, load: float, resolution: float) -> dict[str, Any]:
        """Return the keys that change when a handle of the path has moved to a load."""
        section, scene = self.scene.section, self.scene
        if id.startswith("range-"):
            ends = [*section["load_range"]]
            i = id == "range-high"
            ends[i] = scene.load(load, ends[i], resolution)
            return {"load_range": ends}
        if "crossover_load" in section:
            return {"crossover_load": scene.load(load, section["crossover_load"], resolution)}
        _, number, *end = id.split("-")
        entries = [[*entry] if isinstance(entry, list) else entry for entry in section["crossover_loads"]]
        entry = entries[int(number)]
        if end:
            place = end == ["start"]
            entry[place] = scene.load(load, entry[place], resolution)
        elif isinstance(entry, list):  # a pair of equal loads, or a list with one load
            entries[int(number)] = [scene.load(load, each, resolution) for each in entry]
        else:
            entries[int(number)] = scene.load(load, entry, resolution)
        return {"crossover_loads": entries}
