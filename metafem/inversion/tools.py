"""Tools, one of which makes each asperity: a list of them, or the steps of a range."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import scipy

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.caps import SPHERE, Cap, Caps, Paraboloid, Power, Sphere
from metafem.caps.shapes import STEEPEST
from metafem.contact import Contact, Elastic
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput, refuse_if, shown
from metafem.surface import Surface

# Radii of a range up to COARSE [mm] are multiples of the first step [mm], larger ones of the second: ball-end
# mills are sold in such sizes.
COARSE, STEPS = 1.0, (0.05, 0.1)

# Default spacing of the exponents of a range [-].
EXPONENT_STEP = 0.1

# Multiples of a step are rounded to this many decimals, which removes their rounding error.
DECIMALS = 12

# Number of tools of a range, evenly spaced in logarithms, that are tried for all asperities and of which
# initial guesses consist; changes of tools then reach the others.
TRIED = 7


@dataclass(frozen=True)
class Tool:
    """A tool of which every cap is a copy: a shape with its radius.

    Parameters
    ----------
    radius : float
        R of the caps [mm], positive: of a sphere or a paraboloid, the radius of curvature; it scales the
        profiles of other caps.
    cap : Cap
        Shape of the caps; default: `Sphere()`.

    Raises
    ------
    InvalidInput
        If the radius is not positive, or the cap is not a shape.

    Examples
    --------
    >>> import metafem as mf
    >>> Tool(0.3), Tool(0.8, mf.Power(4))
    (Tool(radius=0.3, cap=Sphere()), Tool(radius=0.8, cap=Power(exponent=4.0, coefficient=0.5)))
    """

    radius: float
    cap: Cap = SPHERE

    def __post_init__(self) -> None:
        check.member(self, "radius", above=0.0)
        if isinstance(self.cap, Caps) or not isinstance(self.cap, Cap):
            words = "must be one cap such as metafem.Sphere() or metafem.Power(4)"
            raise InvalidInput(words, key="cap", value=repr(self.cap))


@dataclass(frozen=True)
class RadiusRange:
    """Range of allowed radii of each asperity.

    Parameters
    ----------
    low, high : float
        Smallest and largest radius [mm], positive and increasing; both are allowed.
    step : float, optional
        Radii between `low` and `high` are multiples of this step [mm]. Default: 0.05 up to 1 mm and 0.1
        above, the steps in which ball-end mills are sold.

    Raises
    ------
    InvalidInput
        If `low` or `step` is not positive, or `high` does not exceed `low`.

    Examples
    --------
    >>> RadiusRange(0.82, 1.23).radii
    array([0.82, 0.85, 0.9 , 0.95, 1.  , 1.1 , 1.2 , 1.23])
    """

    low: float
    high: float
    step: float | None = None

    def __post_init__(self) -> None:
        check.member(self, "low", above=0.0)
        check.member(self, "high", above=self.low)
        check.member(self, "step", optional=True, above=0.0)

    @property
    def radii(self) -> FloatArray:
        """The allowed radii, increasing [mm]."""
        if self.step is not None:
            return _on_steps(self.low, self.high, self.step)
        fine, coarse = (_on_steps(self.low, self.high, step) for step in STEPS)
        return np.unique(np.append(fine[fine <= COARSE], coarse[coarse > COARSE]))

    sizes = radii

    def tools(self, template: Surface) -> list[Tool]:
        """Return a tool of each radius, with the cap of the template."""
        return [Tool(radius, _common_cap(template)) for radius in self.radii.tolist()]


@dataclass(frozen=True)
class PowerRange:
    """Range of exponents of power caps ``f(rho) = c R (rho/R)^n``.

    All caps of the range have the same depth c R at the distance R from the axis: the larger the exponent,
    the flatter the summit and the steeper the side.

    Parameters
    ----------
    low, high : float
        Smallest and largest exponent n [-], greater than 1, at most 32, and increasing; both are allowed.
    step : float
        Exponents between `low` and `high` are multiples of this step [-]. Default: 0.1.
    radius : float, optional
        R of all caps [mm], positive; default: the common radius of the template.
    coefficient : float
        c of all caps [-], positive; default: 0.5, with which the cap of the exponent 2 is a paraboloid of the
        radius R.

    Raises
    ------
    InvalidInput
        If a value is outside its range, or `high` does not exceed `low`.

    Examples
    --------
    >>> PowerRange(1.2, 2, step=0.2).exponents
    array([1.2, 1.4, 1.6, 1.8, 2. ])
    """

    low: float
    high: float
    step: float = EXPONENT_STEP
    radius: float | None = None
    coefficient: float = 0.5

    def __post_init__(self) -> None:
        check.member(self, "low", above=1.0, at_most=STEEPEST)
        check.member(self, "high", above=self.low, at_most=STEEPEST)
        check.member(self, "step", above=0.0)
        check.member(self, "radius", optional=True, above=0.0)
        check.member(self, "coefficient", above=0.0)

    @property
    def exponents(self) -> FloatArray:
        """The allowed exponents, increasing."""
        return _on_steps(self.low, self.high, self.step)

    sizes = exponents

    def tools(self, template: Surface) -> list[Tool]:
        """Return a tool of each exponent."""
        radius = self.radius or _common_radius(template)
        return [Tool(radius, Power(n, self.coefficient)) for n in self.exponents.tolist()]


# The argument `tools` of a design.
Given = RadiusRange | PowerRange | Sequence[Tool | float]


@dataclass(frozen=True, eq=False)
class Tools:
    """The tools of a design, with the law of one contact of each.

    Attributes
    ----------
    all : tuple of Tool
        Of a range, one tool for each step, in order.
    given : RadiusRange, PowerRange, tuple of Tool or of float, or None
        The argument `tools` of the design: a range, different tools or radii [mm], or None.
    laws : tuple of (Contact, float)
        The law of each tool alone for unit E*, and what its methods take as `radius`.
    law : Contact
        The law for all tools, bound to the material and to their caps.
    summits : ndarray, (t,)
        What the methods of `law` take as `radius`, for each tool.
    """

    all: tuple[Tool, ...]
    given: RadiusRange | PowerRange | tuple[Tool | float, ...] | None
    laws: tuple[tuple[Contact, float], ...]
    law: Contact
    summits: Any

    @classmethod
    def of(cls, given: Given | None, template: Surface, contact: Contact) -> Tools:
        """Return the tools of the argument `given`; default: the common radius and cap of the template."""
        if given is None:
            every = [Tool(_common_radius(template), _common_cap(template))]
        elif isinstance(given, (RadiusRange, PowerRange)):
            every = given.tools(template)
        else:
            every = _listed(given, template)
            plain = not any(isinstance(tool, Tool) for tool in given)
            given = tuple(tool.radius if plain else tool for tool in every)
        radius = np.array([tool.radius for tool in every])
        position = np.column_stack([np.cumsum(radius), np.zeros(len(every))])
        cap = Caps.of([tool.cap for tool in every])
        each = Surface(position, np.zeros(len(every)), radius, template.material, cap=cap)
        law: Any = contact.bound(each)
        law = _shared(law) if isinstance(law, Hashable) else law
        summits = np.broadcast_to(law.summits(each), len(every))
        laws = [(law, summit) for summit in summits.tolist()]
        if isinstance(cap, Caps):
            alone = [each.only([i]) for i in range(len(every))]
            laws = [(own := contact.bound(part), float(own.summits(part)[0])) for part in alone]
        return cls(tuple(every), given, tuple(laws), law, summits)

    def __len__(self) -> int:
        return len(self.all)

    @property
    def tried(self) -> IntArray:
        """Tools that are tried for all asperities: all of a list, some of a range."""
        count, given = len(self), self.given
        if count <= TRIED or not isinstance(given, (RadiusRange, PowerRange)):
            return np.arange(count)
        some = np.interp(np.geomspace(given.low, given.high, TRIED), given.sizes, np.arange(count))
        return np.unique(some.round().astype(np.int64))

    @property
    def same_shape(self) -> bool:
        """Whether all tools have one shape, so that they differ by their radius alone."""
        return len({tool.cap for tool in self.all}) == 1

    def only(self, index: int) -> Tools:
        """Return one of the tools as the only one."""
        law, summit = self.laws[index]
        return Tools((self.all[index],), self.given, self.laws[index : index + 1], law, np.array([summit]))

    def radius(self, which: IntArray) -> FloatArray:
        """Return the radii [mm] of asperities made by tools (n,)."""
        return np.array([tool.radius for tool in self.all])[which]

    def cap(self, which: IntArray) -> Cap:
        """Return the caps of asperities made by tools (n,)."""
        return Caps.of([self.all[i].cap for i in which.tolist()])

    def counts(self, which: IntArray) -> dict[str, IntArray | FloatArray]:
        """Return the parameters that state by which tools asperities (n,) are made."""
        if self.given is None:
            return {}
        if not (self.same_shape or isinstance(self.given, PowerRange)):
            return {"tool_counts": np.bincount(which, minlength=len(self))}
        used, counts = np.unique(which, return_counts=True)
        if isinstance(self.given, PowerRange):
            return {"used_exponents": self.given.exponents[used], "exponent_counts": counts}
        return {"used_radii": self.radius(used), "radius_counts": counts}

    def __str__(self) -> str:
        if isinstance(self.given, PowerRange):
            return f"power caps of exponents from {self.given.low:g} to {self.given.high:g}"
        if not self.same_shape:
            return f"{len(self)} tools"
        low, high = (f"{end([tool.radius for tool in self.all]):g}" for end in (min, max))
        return f"radius {low} mm" if len(self) == 1 else f"radii from {low} to {high} mm"


@lru_cache(maxsize=64)
def _shared(law: Any) -> Any:
    """Return the first of equal laws: comparing laws of many caps takes longer than a step of a search."""
    return law


def default_contact(tools: Given | None) -> Contact:
    """Return the default contact law: `Hertz()` if all tools are spheres or paraboloids, or `Elastic()`."""
    listed: Any = tools if isinstance(tools, (Sequence, np.ndarray)) else ()
    other = (isinstance(tool, Tool) and not isinstance(tool.cap, (Sphere, Paraboloid)) for tool in listed)
    return Elastic() if isinstance(tools, PowerRange) or any(other) else PARABOLOID


def refuse_misfits(tools: Tools, template: Surface, top: float) -> None:
    """Raise InvalidInput for tools of several shapes whose caps cannot be `top` [mm] high, or overlap."""
    ranged = isinstance(tools.given, PowerRange)
    words = "tools: a range of exponents is not possible with adhesion; give a list of tools"
    refuse_if(ranged and tools.law.adhesive, words)
    if tools.same_shape and not ranged:
        return
    apart = np.inf
    if template.count > 1:
        distance, _ = scipy.spatial.cKDTree(template.position).query(template.position, k=2)
        apart = float(distance[:, 1].min())
    for tool in tools.all:
        radius = np.array([tool.radius])
        high = float(tool.cap.tallest(radius)[0])
        wide = 2.0 * float(tool.cap.foot_radius(np.array([min(top, high)]), radius)[0])
        refuse_if(
            high < top or wide > apart,
            f"tools: {tool!r} has caps of at most {high:.4g} mm with a foot {wide:.4g} mm wide, but limits "
            f"allow heights of {top:.4g} mm, and the nearest sites are {apart:.4g} mm apart: use another "
            "radius, a smaller max_height or a larger pitch",
        )


def _listed(given: Sequence[Tool | float], template: Surface) -> list[Tool]:
    """Return the different tools of a list, in order; plain radii are sorted and have the template's cap."""
    words = "must be a list of metafem.Tool or of radii [mm], a RadiusRange or a PowerRange"
    values: Any = given
    if isinstance(values, (str, bytes)) or not isinstance(values, (Sequence, np.ndarray)) or not len(values):
        raise InvalidInput(words, key="tools", value=shown(values))
    found = []
    for i, value in enumerate(values):
        if not isinstance(value, Tool):
            wrong = isinstance(value, str) or not check.scalar(value)
            refuse_if(wrong, words, key=f"tools[{i}]", value=shown(value))
            value = Tool(check.number(f"tools[{i}]", value, above=0.0), _common_cap(template))
        found.append(value)
    different = list(dict.fromkeys(found))
    return different if isinstance(values[0], Tool) else sorted(different, key=lambda tool: tool.radius)


def _common_cap(template: Surface) -> Cap:
    words = "has caps that differ; one common cap is needed here, and the argument tools allows several"
    refuse_if(isinstance(template.cap, Caps), words, key="template.cap")
    return template.cap


def _common_radius(template: Surface) -> float:
    low, high = float(template.radius.min()), float(template.radius.max())
    words = "one common radius is needed here, and the argument tools allows several"
    refuse_if(low < high, f"template.radius runs from {low:g} to {high:g} mm; {words}")
    return low


def _on_steps(low: float, high: float, step: float) -> FloatArray:
    """Return the multiples of a step between two values, and the values themselves, increasing."""
    inside = np.round(step * np.arange(np.ceil(low / step), np.floor(high / step) + 1.0), DECIMALS)
    return np.unique(np.concatenate([[low, high], inside]))
