"""Handles of targets that consist of points."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from metafem.errors import InvalidInput
from metafem.explorer.text.marks import Handle, Marks
from metafem.explorer.text.shape import Shape
from metafem.explorer.text.written import ALL_DIGITS, between

# Relative resolution of values that are copied from a table.
EXACT = 10.0 ** (1 - ALL_DIGITS)

# From this number of points on, points that are drawn become a curve that is approximated.
CURVE = 5

# Optional lists with an entry for each point.
OPTIONAL = ("weight", "relative_error")


class PointHandles(Marks):
    """Handles for operating points and samples. Each point moves freely between its neighbours."""

    @property
    def points(self) -> tuple[list[float], list[float]]:
        """Rescaled loads and frictions of the target [mm^2]."""
        target: Any = self.scene.target
        return target.rescaled_load.tolist(), target.rescaled_friction.tolist()

    def handles(self) -> tuple[Handle, ...]:
        """Return a handle for each point."""
        loads, frictions = self.points
        count = len(loads)
        return tuple(
            Handle(f"point-{i}", load, friction, "xy", f"point {i + 1} of {count}")
            for i, (load, friction) in enumerate(zip(loads, frictions, strict=True))
        )

    def shape(self) -> Shape:
        """Return the curve of straight lines from each point to the next."""
        return Shape.through({each.id: (each.load, each.friction) for each in self.handles()})

    def moved(self, handle: Handle, load: float, friction: float, resolution: float) -> dict[str, Any]:
        """Return the keys of the target with one point moved."""
        values, i = self._listed(), int(handle.id.removeprefix("point-"))
        return self._placed(i, (i - 1, i + 1), values, (load, friction), resolution)

    def added(self, load: float, friction: float, resolution: float) -> dict[str, Any]:
        """Return the keys of the target with one more point; operating points can become a sampled curve."""
        values, loads = self._listed(), self.points[0]
        if self.scene.kind == "operating-points" and len(loads) + 1 >= CURVE:
            values["kind"] = "sampled"
        i = sum(other <= load for other in loads)
        near = min(i, len(loads) - 1)
        for name, entries in values.items():
            if isinstance(entries, list):
                values[name] = [*entries[:i], 1.0 if name == "weight" else entries[near], *entries[i:]]
        return self._placed(i, (i - 1, i), values, (load, friction), resolution)

    def removed(self, id: str) -> dict[str, Any]:
        """Return the keys of the target without one of its points."""
        values, count = self._listed(), len(self.points[0])
        found = [handle.id for handle in self.handles()]
        if id not in found:
            raise InvalidInput(f'the target has no handle "{id:.40}"')
        if count == 1:
            raise InvalidInput("the last point cannot be removed; a target needs at least one")
        i = found.index(id)
        return {
            name: [*entries[:i], *entries[i + 1 :]] if isinstance(entries, list) else entries
            for name, entries in values.items()
        }

    def _placed(
        self,
        i: int,
        near: tuple[int, int],
        values: dict[str, Any],
        at: tuple[float, float],
        resolution: float,
    ) -> dict[str, Any]:
        """Return the lists with point `i` moved to the load and friction `at`.

        The new values stay between the values of the points with the indices `near`.
        """
        for name, stated, numbers, value in zip(
            self._names(), (self.scene.load, self.scene.friction), self.points, at, strict=True
        ):
            low = numbers[near[0]] if near[0] >= 0 else 0.0
            high = numbers[near[1]] if near[1] < len(numbers) else math.inf
            if low >= high:  # the friction of noisy samples may decrease
                low, high = 0.0, math.inf
            placed, fine = between(value, low, high, resolution)
            placed = placed or resolution * numbers[0]  # a single point must not reach 0
            values[name][i] = stated(placed, values[name][i], fine)
        return values

    def _names(self) -> tuple[str, str]:
        """Return the keys of loads and frictions; for a table, the keys with the units of its columns."""
        section, forces = self.scene.section, self.scene.target.wording.shear_stress is not None
        rescaled = "rescaled_load" in section or ("load" not in section and not forces)
        return ("rescaled_load", "rescaled_friction") if rescaled else ("load", "friction_force")

    def _listed(self) -> dict[str, Any]:
        """Return the lists of the points as written; for a table, lists that replace the file name."""
        section, scene = self.scene.section, self.scene
        names = self._names()
        if "file" not in section:
            listed = [key for key in OPTIONAL if isinstance(section.get(key), list)]
            return {name: [*section[name]] for name in (*names, *listed)}
        like = "1 mm^2" if names[0] == "rescaled_load" else "1 N"
        loads, frictions = self.points
        target: Any = scene.target
        weight, error = target.weight.tolist(), target.relative_error
        more = {} if len(set(weight)) == 1 else {"weight": weight}
        return {
            "file": None,
            names[0]: [scene.load(load, like, EXACT) for load in loads],
            names[1]: [scene.friction(friction, like, EXACT) for friction in frictions],
            **(more if error is None else {"relative_error": error.tolist()}),
        }


class BandCurves(Marks):
    """The two curves of a band, without handles."""

    def handles(self) -> tuple[Handle, ...]:
        """Return no handles; the values are edited in the text."""
        return ()

    def shape(self) -> Shape:
        """Return the two curves, with a gap between them."""
        target: Any = self.scene.target
        load, gap = target.rescaled_load, [math.nan]
        return Shape(np.concatenate([load, gap, load]), np.concatenate([target.lowest, gap, target.highest]))
