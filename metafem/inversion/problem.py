"""An inversion problem: checked arguments with defaults, asperities on its sites, and candidates for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.inversion.bounds import Bounds
from metafem.inversion.limits import Limits, pinned_heights
from metafem.inversion.target_law import Target, TargetLaw
from metafem.inversion.tools import Given, Tools, default_contact, refuse_misfits
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.notes import Note
from metafem.surface import Surface

Parameter = float | int | FloatArray | IntArray

# Number of loads at which the slope of a straight branch is fitted.
BRANCH_POINTS = 76

# The interaction margin is computed at these fractions of the last load of the target.
MARGIN_LOADS = np.array([0.25, 0.5, 1.0])

# Smallest height of a summit of a part over the largest height: about the resolution of a machine.
SMALLEST = 1e-3

# Tool index of a site without an asperity.
NONE = -1

# Whether designs in the current context are drafts, which are shown while the user drags a point.
_DRAFT: ContextVar[bool] = ContextVar("draft", default=False)


@contextmanager
def drafting() -> Iterator[None]:
    """Limit designs in the body of the `with` statement to a short search.

    If a draft raises Infeasible with `by_search` True, a full design may still reach the target.
    """
    token = _DRAFT.set(True)
    try:
        yield
    finally:
        _DRAFT.reset(token)


@dataclass(frozen=True, eq=False)
class Asperities:
    """Heights [mm] above the base plane on all sites, (N,), and the index of the tool of each, or `NONE`."""

    height: FloatArray
    tool: IntArray

    @property
    def exists(self) -> NDArray[np.bool_]:
        """Whether there is an asperity at each site, (N,)."""
        return np.asarray(self.tool != NONE)

    @property
    def sites(self) -> IntArray:
        """Sites with an asperity, increasing, (n,)."""
        return np.flatnonzero(self.tool != NONE)

    def with_heights(self, height: FloatArray) -> Asperities:
        """Return the asperities with other heights (n,) on the same sites."""
        every = self.height.copy()
        every[self.sites] = height
        return Asperities(every, self.tool)


@dataclass(frozen=True)
class Branch:
    """A straight branch of the target: slope [-] and intercept [mm^2] over a range of rescaled loads.

    The intercept is None if the target leaves it free.
    """

    slope: float
    load_range: tuple[float, float]
    intercept: float | None = None

    @property
    def load(self) -> FloatArray:
        """Rescaled loads at which the slope is fitted, (76,) [mm^2]."""
        return np.linspace(*self.load_range, BRANCH_POINTS)


@dataclass(frozen=True, eq=False)
class Candidate:
    """Asperities, the law of the target or of a height density, and data for the design.

    - `density`: the `ExponentialDensity` that the heights follow, or None.
    - `parameters`: quantities of the design that hold for these asperities alone, such as levels.
    - `found`: quantities that were found on the way.
    - `stepped`: whether the heights are on the levels of the limits.
    - `refined`: whether the heights were changed under the model.
    - `unrounded` [-]: misfit before the heights were rounded to steps.
    """

    asperities: Asperities
    law: TargetLaw
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    found: Mapping[str, Parameter] = field(default_factory=dict)
    branches: tuple[Branch, ...] = ()
    density: Any = None
    notes: tuple[Note, ...] = ()
    stepped: bool = False
    refined: bool = False
    unrounded: float | None = None

    def with_asperities(self, at: Asperities) -> Candidate:
        """Return the candidate with other asperities, without the parameters of the former ones."""
        return replace(self, asperities=at, parameters={})


@dataclass(frozen=True, eq=False)
class Problem:
    """A target, and all constraints on the surface that must meet it."""

    target: Target
    template: Surface
    tools: Tools
    model: Model
    limits: Limits
    pinned: Mapping[int, float | None]
    draft: bool = False

    @classmethod
    def checked(
        cls,
        target: Target,
        template: Surface,
        model: Model | None = None,
        limits: Limits | None = None,
        tools: Given | None = None,
    ) -> Problem:
        """Return the problem of these arguments, or raise InvalidInput if one has the wrong type.

        Defaults: independent asperities, heights up to the tallest of the template, and its common radius.
        """
        kinds = "one of OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw, MultilinearLaw, Band"
        check.instance("target", target, Target, kinds)
        check.instance("template", template, Surface, "a metafem.Surface")
        bounds = Limits(max_height=float(template.height.max())) if limits is None else limits
        solver: Any = Independent(default_contact(tools)) if model is None else model
        check.instance("model", solver, Model, "a model such as metafem.Independent()")
        check.instance("limits", bounds, Limits, "metafem.Limits")
        pinned = pinned_heights(template, bounds)
        choice = Tools.of(tools, template, contact_of(solver))
        refuse_misfits(choice, template, bounds.top)
        # messages state loads in N and in mm^2
        any_kind: Any = target.rounded()
        target = replace(any_kind, wording=target.wording.of_part(template.material))
        return cls(target, template, choice, solver, bounds, pinned, _DRAFT.get())

    @cached_property
    def law(self) -> Any:
        """`TargetLaw` of the target; None if that of a height density is sought."""
        return self.target.curve()

    @cached_property
    def uncoupled(self) -> Independent:
        """Model of surfaces whose asperities are independent, with the contact law of the model."""
        return Independent(contact=contact_of(self.model))

    @cached_property
    def independent(self) -> Independent:
        """Model of lists of heights: independent asperities with the law of the tools, not for surfaces."""
        return Independent(contact=self.tools.law)

    @cached_property
    def bounds(self) -> Bounds:
        """Bounds on the friction of independent asperities up to the last load of the target."""
        unlimited = Bounds(self.tools, self.count, 0.0)
        last = unlimited.largest_load(self.limits) if self.law is None else float(self.law.load[-1])
        return replace(unlimited, last=last)

    @cached_property
    def open(self) -> IntArray:
        """Sites that may have an asperity, increasing."""
        empty = [site for site, height in self.pinned.items() if height is None]
        return np.setdiff1d(np.arange(self.template.count), np.array(empty, dtype=np.int64))

    @cached_property
    def held(self) -> dict[int, float]:
        """Prescribed heights above the base plane [mm], by site."""
        return {site: height for site, height in self.pinned.items() if height is not None}

    @property
    def count(self) -> int:
        """Number of sites that may have an asperity."""
        return len(self.open)

    @property
    def foot(self) -> float:
        """Smallest height above the base plane [mm]; caps of a part need a height."""
        if self.template.block is None:
            return self.limits.foot
        return max(self.limits.foot, SMALLEST * self.limits.top)

    def alone(self, tool: int) -> Problem:
        """Return the problem in which all asperities are made by one tool."""
        return replace(self, tools=self.tools.only(tool))

    def placed(
        self, height: FloatArray, tool: IntArray, rng: np.random.Generator, top: float | None = None
    ) -> Asperities:
        """Return asperities on random sites; heights (n,) [mm] are relative to the tallest, at `top` [mm].

        Default: the largest height. Prescribed heights replace the nearest heights, on their own sites.
        """
        highest = self.limits.top if top is None else top
        every, which = np.full(self.template.count, highest), np.full(self.template.count, NONE)
        height = np.maximum(highest + height - height.max(), self.foot)
        left = np.ones(len(height), dtype=bool)
        for site, given in self.held.items():
            distance = np.abs(height - given)
            nearest = int(np.where(left, distance, np.inf).argmin() if left.any() else distance.argmin())
            every[site], which[site] = given, tool[nearest]
            left[nearest] = False
        # the order depends on the template alone, so that a site that becomes empty moves no other
        order = rng.permutation(self.template.count)
        free = order[np.isin(order, np.setdiff1d(self.open, list(self.held)))]
        rest = np.flatnonzero(left)[: len(free)]
        every[free[: len(rest)]], which[free[: len(rest)]] = height[rest], tool[rest]
        return Asperities(every, which)

    def surface(self, at: Asperities) -> Surface:
        """Return the surface of the existing asperities."""
        some, which = at.sites, at.tool[at.sites]
        radius, cap = self.tools.radius(which), self.tools.cap(which)
        return self.template.only(some, height=at.height[some], radius=radius, cap=cap)

    @cached_property
    def margin(self) -> float:
        """Twice the largest relative change of A0 [-] that interaction causes for equal heights.

        The change is evaluated at three loads up to the last load of the target. A target is refused only if
        it exceeds a bound for independent asperities by more than this margin.
        """
        if not self.model.couples or self.law is None:
            return 0.0
        load, most = float(self.law.load[-1]) * MARGIN_LOADS, 0.0
        for tool in {0, len(self.tools) - 1}:
            every = Asperities(np.zeros(self.template.count), np.full(self.template.count, NONE))
            every.tool[self.open] = tool
            equal = self.surface(every)
            change = self.model.curve(equal, load).area / self.uncoupled.curve(equal, load).area - 1.0
            most = max(most, 2.0 * float(np.abs(change).max()))
        return most


def misfit(problem: Problem, at: Asperities, law: TargetLaw, model: Any = None) -> float:
    """Return the misfit [-] of asperities under a model; default: that of the problem."""
    solver = problem.model if model is None else model
    return law.misfit(solver.curve(problem.surface(at), law.load).checked().area)
