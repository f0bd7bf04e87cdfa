"""Arguments of an inversion, checked and with their defaults."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

from metafem import _validate as check
from metafem.errors import InvalidInput
from metafem.inversion.limits import Limits
from metafem.inversion.placement.layout import Layout
from metafem.inversion.radii import Radii, RadiusRange
from metafem.inversion.targets.laws import Target
from metafem.models import Independent, Model
from metafem.surface import Surface


@dataclass(frozen=True, eq=False)
class Request:
    """Arguments of an inversion with all defaults filled in."""

    target: Target
    template: Surface
    radii: Radii
    model: Model
    limits: Limits
    layout: Layout | None

    @classmethod
    def checked(
        cls,
        target: Target,
        template: Surface,
        radii: RadiusRange | Sequence[float] | None,
        model: Model | None,
        limits: Limits | None,
        layout: Layout | None,
    ) -> Request:
        """Return the arguments with defaults, or raise InvalidInput for one of the wrong kind.

        The default of `radii` is the common radius of the template.
        """
        kinds = get_args(Target)
        if type(target) not in kinds:
            known = ", ".join(kind.__name__ for kind in kinds)
            raise InvalidInput(f"target = {target!r:.60} must be one of {known}")
        check.instance("template", template, Surface, "a metafem.Surface")
        solver: Model = Independent() if model is None else model
        check.instance("model", solver, Model, "a model such as metafem.Independent()")
        bounds = Limits(max_height=float(template.height.max())) if limits is None else limits
        check.instance("limits", bounds, Limits, "metafem.Limits")
        if layout is not None:
            check.instance("layout", layout, Layout, "metafem.Layout")
        choice = Radii.common(template) if radii is None else Radii.given(radii)
        return cls(target, template, choice, solver, bounds, layout)
