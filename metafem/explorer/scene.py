"""A target with its draggable points, and the table with other numbers of it in the units of the user."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.explorer.fields import ALL_DIGITS, EXACT, rounded, scaled
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
        return str(self.section["kind"])

    @property
    def crowd(self) -> int:
        """The number of points of a target that has too many of them for handles, otherwise 0."""
        return 0 if self._drawn[0] else len(getattr(self.target, "rescaled_friction", ()))

    @cached_property
    def section(self) -> Keys:
        """The keys and values of the target in the table; lists in place of the name of a file."""
        section = {**section_of(self.state.table, "target")}
        if section.pop("file", None) is None:
            return section
        given = members(self.target, COLUMNS)
        if len(set(given["weight"])) == 1:  # the default
            del given["weight"]
        return section | self.stated(given, EXACT)

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
        """Return the table with other numbers of the target in the units in which they are written.

        Numbers that do not change remain as they are written; the number None removes its key.
        """
        values = {**self.section, **self.stated(numbers, resolution, self.section)}
        return with_only(self.state.table, "target", {**values, "kind": kind or self.kind})

    def stated(
        self, numbers: Numbers, resolution: float, like: Keys | None = None, wording: Wording | None = None
    ) -> Keys:
        """Return the keys and values of numbers of a target.

        New values have the units of the present keys and values `like`, or those of the wording, default:
        that of the target.
        """
        units, found = wording or self.target.wording, dict[str, Any]()
        for name, number in numbers.items():
            key = NEWTON_KEYS.get(name, name) if units.per_slope else name
            write = partial(self._entry, name, resolution, units)
            before = plain(getattr(self.target, name, None))
            found[key] = None if number is None else _like(number, before, (like or {}).get(key), write)
        return found

    def _entry(
        self, name: str, resolution: float, units: Wording, number: float, before: float, old: str | None
    ) -> Any:
        """Return a number of a target as an entry of the table: like an old entry, or in the units."""
        if name in (*PLAIN, *SLOPES):
            return rounded(number if name in PLAIN else units.coefficient(number), resolution)
        if old is not None:
            return scaled(old, number / before, resolution)
        template, factor, unit = self.specification.template, 1.0, "mm^2"
        if units.per_slope if name in NEWTON_KEYS else units.composite_modulus:
            factor, unit = template.material.composite_modulus, "N"
            if name in FRICTIONS and template.friction is not None:
                factor = template.friction.stress
        return f"{rounded(factor * number, resolution):.{ALL_DIGITS}g} {unit}"


def _like(number: Any, before: Any, old: Any, write: Callable[[Any, Any, Any], Any]) -> Any:
    """Return a number, or numbers, as written by `write` in the form of the `old` value of `before`."""
    if old is not None and number == before:
        return old
    if not isinstance(number, Sequence):
        return write(number, before, old)
    if old is None:
        return [write(each, None, None) for each in number]
    if not isinstance(old, list):  # one load in place of a pair of equal loads
        return write(number[0], before[0], old)
    known = dict(zip(before, old, strict=True))
    places = [min(i, len(old) - 1) for i in range(len(number))]  # a point may have been added
    pairs = zip(number, places, strict=True)
    return [known.get(each) or _like(each, before[i], old[i], write) for each, i in pairs]
