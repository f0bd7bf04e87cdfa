"""A target with its draggable points, and the table with other numbers of it in the units of the user."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.explorer.fields import ALL_DIGITS, rounded
from metafem.explorer.history import State
from metafem.explorer.table import Table, section_of, with_only
from metafem.files import Specification
from metafem.inversion import Design
from metafem.inversion.wording import Wording

# Keys of the members of a target that a specification can also give as forces or friction coefficients.
NEWTON_KEYS = {
    "rescaled_load": "load",
    "rescaled_friction": "friction_force",
    "lowest": "lowest_force",
    "highest": "highest_force",
    "slope": "friction_coefficient",
    "slopes": "friction_coefficients",
}

# Members of a target that are frictions, slopes, and those without a unit.
FRICTIONS = ("rescaled_friction", "lowest", "highest")
SLOPES = ("slope", "slopes")
PLAIN = ("exponent", "prefactor", "weight", "relative_error")

# Members of a target that have an entry for each point.
COLUMNS = ("rescaled_load", "rescaled_friction", "weight", "relative_error")

# Relative resolution of numbers that are written in another unit, which costs the last digits.
KEPT = 1e-13

# Members of a target by name: slopes [-], loads and frictions [mm^2]; and keys of a table with their values.
Numbers = dict[str, Any]
Keys = dict[str, Any]


def members(target: Any, names: Iterable[str]) -> Numbers:
    """Return the numbers of a target by name, of those names that it has."""
    found = {name: plain(getattr(target, name, None)) for name in names}
    return {name: number for name, number in found.items() if number is not None}


def plain(number: Any) -> Any:
    """Return a number, or the entries of an array as a list."""
    return number.tolist() if isinstance(number, np.ndarray) else number


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


# The handles of a target, and its curve as rescaled loads and frictions [mm^2], nan in gaps.
Drawn = tuple[list[Handle], tuple[FloatArray, FloatArray]]


@dataclass(frozen=True, eq=False)
class Scene:
    """The target of a state, with its specification, the last design, and what draws targets of its kind."""

    state: State
    specification: Specification
    design: Design | None
    draw: Callable[[Scene], Drawn]

    @property
    def target(self) -> Any:
        """The target of the specification."""
        return self.specification.target

    @property
    def kind(self) -> str:
        """The kind of the target."""
        return str(self.given["kind"])

    @property
    def given(self) -> Keys:
        """The keys and values of the target in the table."""
        return section_of(self.state.table, "target")

    @property
    def crowd(self) -> int:
        """The number of points of a target that has too many of them for handles, otherwise 0."""
        return 0 if self._drawn[0] else len(getattr(self.target, "rescaled_friction", ()))

    @cached_property
    def section(self) -> Keys:
        """The keys and values of the target in the table; lists in place of the name of a file."""
        section = {name: value for name, value in self.given.items() if name != "file"}
        if "file" not in self.given:
            return section
        given = members(self.target, COLUMNS)
        if len(set(given["weight"])) == 1:  # the default
            del given["weight"]
        return section | self.stated(given, KEPT)

    @cached_property
    def _drawn(self) -> Drawn:
        return self.draw(self)

    def handles(self) -> list[Handle]:
        """Return the handles; a target with too many points has none."""
        return self._drawn[0]

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return rescaled load and friction of the target [mm^2], nan in gaps."""
        return self._drawn[1]

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

    def written(self, numbers: Numbers, resolution: float, kind: str = "") -> Table:
        """Return the table with other numbers of the target; the number None removes its key."""
        values = {**self.section, **self.stated(numbers, resolution), "kind": kind or self.kind}
        return with_only(self.state.table, "target", values)

    def stated(self, numbers: Numbers, resolution: float, wording: Wording | None = None) -> Keys:
        """Return the keys and values of numbers of a target in newtons or rescaled, as a wording has them.

        The default is the wording of the target. Numbers that the target has keep their digits, and keys
        whose numbers do not change the text of their values.
        """
        units, found = wording or self.target.wording, Keys()
        for name, number in numbers.items():
            key = NEWTON_KEYS.get(name, name) if units.per_slope else name
            before = plain(getattr(self.target, name, None))
            if number is None or (number == before and key in self.given):
                found[key] = None if number is None else self.given[key]
            else:
                known = set() if before is None else {*np.ravel(before).tolist()}
                found[key] = self._value(name, number, units, resolution, known)
        return found

    def _value(self, name: str, number: Any, units: Wording, resolution: float, known: set[float]) -> Any:
        """Return a number of a target, or numbers, as a value of the table."""
        if isinstance(number, Sequence):
            values = [self._value(name, each, units, resolution, known) for each in number]
            return values[0] if name == "crossover_loads" and values == values[:1] * 2 else values
        resolution = KEPT if number in known else resolution
        if name in (*PLAIN, *SLOPES):
            return rounded(number if name in PLAIN else units.coefficient(number), resolution)
        template, factor, unit = self.specification.template, 1.0, "mm^2"
        if units.per_slope if name in NEWTON_KEYS else units.composite_modulus:
            factor, unit = template.material.composite_modulus, "N"
            if name in FRICTIONS and template.friction is not None:
                factor = template.friction.stress
        return f"{rounded(factor * number, resolution):.{ALL_DIGITS}g} {unit}"
