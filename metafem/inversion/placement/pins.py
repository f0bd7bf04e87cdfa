"""Sites of a template without an asperity, and sites with given heights."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray, IntArray
from metafem.errors import refuse_if
from metafem.inversion.limits import Limits
from metafem.surface import Surface

# Heights [mm] above the base plane by site, None for a site without an asperity.
Pinned = Mapping[int, float | None]


@dataclass(frozen=True, eq=False)
class Pins:
    """All sites of a template, and those that are empty or have a given height.

    An inversion uses only the other sites, with new numbers: `open` (m,) holds their numbers in the
    template. Of these, the ones with indices `rows` (k,) have the heights `heights` (k,) [mm].
    """

    template: Surface
    pinned: Pinned

    @classmethod
    def given(cls, template: Surface, limits: Limits) -> Pins:
        """Return the pins of the limits, or raise InvalidInput for those that do not fit the template."""
        pinned: Any = limits.pinned
        words = "a mapping of site numbers to heights [mm] or None, for example {9: 0.15, 3: None}"
        check.instance("pinned", pinned, Mapping, words)  # type: ignore[type-abstract]
        found: dict[int, float | None] = {}
        last = template.count - 1
        for site, height in pinned.items():
            name = f"pinned[{shown(site)}]"
            whole = isinstance(site, (int, np.integer)) and not isinstance(site, (bool, np.timedelta64))
            known = whole and 0 <= site <= last
            refuse_if(not known, f"{name} is not a site: the template has the sites 0 to {last}")
            found[int(site)] = None if height is None else _checked_height(name, height, limits)
            flat = height is not None and found[int(site)] == 0.0 and template.block is not None
            refuse_if(flat, f"{name} = 0 is no summit of a part; write None for an empty site")
        pins = cls(template, MappingProxyType(dict(sorted(found.items()))))
        words = f"pinned leaves all {template.count} sites empty; leave out at least one site"
        refuse_if(not pins.open.size, words)
        return pins

    @cached_property
    def open(self) -> IntArray:
        """Sites of the template that may have an asperity, increasing, (m,)."""
        empty = [site for site, height in self.pinned.items() if height is None]
        return np.setdiff1d(np.arange(self.template.count), np.array(empty, dtype=np.int64))

    @cached_property
    def rows(self) -> IntArray:
        """Indices in `open` of the sites whose heights are given, increasing, (k,)."""
        sites = [site for site, height in self.pinned.items() if height is not None]
        return np.searchsorted(self.open, np.array(sites, dtype=np.int64))

    @cached_property
    def heights(self) -> FloatArray:
        """Given heights above the base plane at the sites `rows`, (k,) [mm]."""
        return np.array([height for height in self.pinned.values() if height is not None], dtype=np.float64)

    def placed(self, permutation: IntArray) -> IntArray:
        """Return a permutation of all template sites without the empty ones, numbered as in `open`."""
        number = np.full(self.template.count, -1)
        number[self.open] = np.arange(len(self.open))
        found = number[permutation]
        return np.asarray(found[found >= 0])

    @cached_property
    def reduced(self) -> Surface:
        """The template without the empty sites."""
        template, some = self.template, self.open
        if len(some) == template.count:
            return template
        return template.replaced(
            position=template.position[some], height=template.height[some], radius=template.radius[some]
        )


def _checked_height(name: str, height: Any, limits: Limits) -> float:
    """Return a height above the base plane [mm], or raise InvalidInput for one outside the limits."""
    found = check.number(name, height, at_least=0.0)
    top = limits.offset + limits.max_height
    must = "must be at most {.number}, limits.offset + limits.max_height, which are measured from the base "
    refuse_if(found > top, must + "plane as this height is", Given(name, top), key=name, value=found)
    return found
