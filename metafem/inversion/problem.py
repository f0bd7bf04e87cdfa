"""Definition of an inversion problem: checked arguments, with defaults."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem.contact import Contact
from metafem.inversion.bounds import Bounds
from metafem.inversion.limits import Limits, Pins
from metafem.inversion.search.levenberg_marquardt import DEFAULTS, OTHER_LAWS, SearchOptions
from metafem.inversion.targets.target import Target
from metafem.inversion.tools import kit
from metafem.inversion.tools.kit import Choice, Given, Kit
from metafem.inversion.tools.kit_bounds import KitBounds
from metafem.inversion.tools.radii import Radii
from metafem.inversion.tools.tool import Tool
from metafem.models import Independent, Model
from metafem.models.model import contact_of, has_paraboloids
from metafem.surface import Surface

# The interaction margin is computed at these fractions of the last load of the target.
MARGIN_LOADS = np.array([0.25, 0.5, 1.0])


@dataclass(frozen=True)
class Effort:
    """Numbers of trials in the searches of a design; most trials are random changes."""

    # Restarts for independent asperities, about 10 ms each. Most laws of real surfaces need few or none.
    restarts: int = 30
    # The same for adhesive asperities, about 30 ms each.
    adhesive_restarts: int = 10
    # Misfits at which the random search for operating points without levels ends. A descent to rounding
    # follows. If it ends at a kink, the next misfit gives another initial guess.
    free_goals: tuple[float, ...] = (1e-2, 1e-3, 1e-4, 1e-5, 1e-11)
    # Maximum number of loads at which heights of independent asperities are sought. Initial guesses take
    # .4 ms for each load.
    searched_loads: int = 1_000_000
    # Maximum number of initial guesses for operating points under another model.
    refined_guesses: int = 4
    # Maximum number of steps of a descent to rounding under another model.
    refined_steps: int = DEFAULTS.most_exact_steps
    # Restarts under another model, where a descent takes ten times as long as for independent asperities.
    refined_restarts: int = 3
    # Restarts for independent asperities whose target is divided by a ratio of laws, about 3 ms each.
    ratio_restarts: int = 10
    # Initial guesses for mixtures of tools of several shapes, about 10 ms each.
    mixtures: int = 20
    # Restarts for each trial of the load range of a line. Most ranges that are too wide use all restarts.
    range_restarts: int = 4
    # Random changes of the other heights if a design with prescribed heights misses the target, about 5 ms
    # each.
    pinned_changes: int = 8
    # Maximum number of changes of heights on steps, and number of candidates evaluated for each change.
    step_changes: int = 60
    evaluated_steps: int = 24
    # Number of loads of a design's law, and step between the loads at which the slopes of its branches are
    # fitted. Under another model each load of 400 asperities takes a millisecond.
    law_points: int = 100
    branch_step: int = 1
    # Maximum number of loads at which heights are refined under another model, unless they must meet points.
    refined_loads: int = 1000
    # Misfit at which the refinement under another model ends, if this is above its usual goal.
    refined_goal: float = 0.0


# Effort of a draft, which is shown while the user drags a handle; operating points that are dragged under a
# model with interaction are met within 1 %.
DRAFT = Effort(
    restarts=2, adhesive_restarts=1, free_goals=(1e-2,), searched_loads=15, refined_guesses=1,
    refined_steps=20, refined_restarts=0, ratio_restarts=2, mixtures=4, range_restarts=0, pinned_changes=1,
    step_changes=1, evaluated_steps=6, law_points=25, branch_step=5, refined_loads=15, refined_goal=2e-3,
)  # fmt: skip

WHOLE = Effort()

# Effort of designs in the current context.
EFFORT: ContextVar[Effort] = ContextVar("effort", default=WHOLE)


@contextmanager
def drafting() -> Iterator[None]:
    """Limit designs in the body of the `with` statement to a short search.

    If a draft raises Infeasible with `by_search` True, a full design may still reach the target.
    """
    token = EFFORT.set(DRAFT)
    try:
        yield
    finally:
        EFFORT.reset(token)


@dataclass(frozen=True, eq=False)
class Problem:
    """A target, and all constraints on the surface that must meet it.

    The template contains only the sites that may have an asperity, in the order of `pins.open`.
    """

    target: Target
    template: Surface
    tools: Choice
    model: Model
    limits: Limits
    pins: Pins
    options: SearchOptions = DEFAULTS
    effort: Effort = WHOLE

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
        choice, template = kit.chosen(tools, template)
        solver: Model = Independent(kit.default_contact(tools)) if model is None else model
        checks: tuple[tuple[str, Any, Any, str], ...] = (
            ("model", solver, Model, "a model such as metafem.Independent()"),
            ("limits", bounds, Limits, "metafem.Limits"),
        )
        for each in checks:
            check.instance(*each)
        pins = Pins.given(template, bounds)
        template = pins.reduced
        kit.refuse_misfits(choice, template, bounds.top, contact_of(solver))
        options = DEFAULTS if has_paraboloids(solver) else OTHER_LAWS
        # messages state loads in N and in mm^2
        any_kind: Any = target
        target = replace(any_kind, wording=target.wording.of_part(template.material))
        return cls(target, template, choice, solver, bounds, pins, options, EFFORT.get())

    @cached_property
    def _pressed(self) -> tuple[Contact, Any]:
        return kit.pressed(self.tools, self.template, contact_of(self.model))

    @property
    def contact(self) -> Contact:
        """Law of one contact of the tools, for the material of the template; see `pressed`."""
        return self._pressed[0]

    @property
    def radii(self) -> Radii:
        """The choice of radii, if all caps have the same shape."""
        assert isinstance(self.tools, Radii)
        return self.tools

    @property
    def tool_summits(self) -> Any:
        """What the methods of `contact` take as `radius`, for each tool of a kit."""
        return self._pressed[1]

    def alone(self, tool: Tool) -> Problem:
        """Return the problem in which all asperities are made by one tool."""
        pins = replace(self.pins, template=tool.on(self.pins.template))
        return replace(self, template=tool.on(self.template), pins=pins, tools=Radii.of(tool.radius))

    @cached_property
    def uncoupled(self) -> Independent:
        """Model of surfaces whose asperities are independent, with the contact law of the model."""
        return Independent(contact=contact_of(self.model))

    @cached_property
    def independent(self) -> Independent:
        """Model of lists of heights: independent asperities with the law `contact`, not for surfaces."""
        return Independent(contact=self.contact)

    @cached_property
    def bounds(self) -> Bounds:
        """Bounds on the friction of independent asperities up to the last load of the target."""
        if isinstance(self.tools, Kit):
            return KitBounds.of(tuple(self.alone(tool).bounds for tool in self.tools.tools), self.contact)
        unlimited = Bounds(self.contact, self.tools, self.count, 0.0)
        last = self.target.last_load or unlimited.largest_load(self.limits)
        return replace(unlimited, last=last)

    @property
    def restarts(self) -> int:
        """Number of restarts of a search for independent asperities."""
        return self.effort.adhesive_restarts if self.contact.adhesive else self.effort.restarts

    @property
    def count(self) -> int:
        """Number of sites N, which is the maximum number of asperities."""
        return self.template.count

    def interaction_margin(self) -> float:
        """Return twice the largest relative change of A0 [-] that interaction causes for equal heights.

        The change is evaluated at three loads up to the last load of the target. A target is refused only if
        it exceeds a bound for independent asperities by more than this margin.
        """
        last = self.target.last_load
        if not self.model.couples or self.count == 1 or last is None:
            return 0.0
        if isinstance(self.tools, Kit):
            return max(self.alone(tool).interaction_margin() for tool in self.tools.tools)
        equal = self.template.replaced(height=np.zeros(self.count), radius=self.tools.high)
        load = last * MARGIN_LOADS
        change = self.model.curve(equal, load).area / self.uncoupled.curve(equal, load).area - 1.0
        return 2.0 * float(np.abs(change).max())
