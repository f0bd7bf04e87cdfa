"""Choice of the tool of each asperity, for caps of several shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray, IntArray
from metafem.caps import Cap, Caps, Paraboloid, Power, Sphere
from metafem.contact import Contact, Elastic
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput, refuse_if
from metafem.inversion.tools.radii import Radii
from metafem.inversion.tools.ranges import PowerRange, RadiusRange
from metafem.inversion.tools.tool import Tool
from metafem.surface import Surface

# The argument `tools` of a design.
Given = RadiusRange | PowerRange | Sequence[Tool | float]

# Number of logarithmically spaced exponents of a range that are tried for all asperities, and of which the
# initial guesses of mixtures consist.
TRIED_EXPONENTS = 7


@dataclass(frozen=True)
class Kit:
    """Tools with caps of several shapes, one of which makes each asperity.

    Of a range of exponents, `tools` are some power caps, with increasing exponents from the smallest to the
    largest.
    """

    tools: tuple[Tool, ...]
    range: PowerRange | None = None

    @classmethod
    def of_range(cls, given: PowerRange, radius: float) -> Kit:
        """Return the kit of a range of exponents; `radius` [mm] is used if the range has none."""
        size = radius if given.radius is None else given.radius
        between = given.nearest(np.geomspace(given.low, given.high, TRIED_EXPONENTS))
        exponents = np.union1d([given.low, given.high], between).tolist()
        return cls(tuple(Tool(size, Power(n, given.coefficient)) for n in exponents), given)

    @property
    def single(self) -> bool:
        """Whether only one tool is possible: never."""
        return False

    @property
    def given_as(self) -> PowerRange | tuple[Tool, ...]:
        """The range or the tools, as in the argument `tools` of `design`."""
        return self.tools if self.range is None else self.range

    def surface(self, template: Surface) -> Surface:
        """Return a surface of the material of the template with one cap of each tool, in their order."""
        count = len(self.tools)
        radius = [tool.radius for tool in self.tools]
        position = np.column_stack([np.cumsum(radius), np.zeros(count)])
        cap = [tool.cap for tool in self.tools]
        return Surface(position, np.zeros(count), radius, template.material, cap=cap)

    def made(self, which: IntArray) -> tuple[FloatArray, Cap]:
        """Return the radii [mm] and the caps of asperities made by tools, given by their indices (n,)."""
        return self.radii[which], Caps.of([self.tools[i].cap for i in which.tolist()])

    @property
    def radii(self) -> FloatArray:
        """Radii of the tools [mm]."""
        return np.array([tool.radius for tool in self.tools])

    def __str__(self) -> str:
        if self.range is None:
            return f"{len(self.tools)} tools"
        return f"power caps of exponents from {self.range.low:g} to {self.range.high:g}"


Choice = Radii | Kit


def chosen(tools: Given | None, template: Surface) -> tuple[Choice, Surface]:
    """Return the choice that the argument `tools` states, and the template with the cap of all tools.

    Default: the common radius and cap of the template. Numbers are tools of these radii with the common cap
    of the template. Tools of one shape are a choice of radii.
    """
    if isinstance(tools, PowerRange):
        radius = template.radius if tools.radius is None else np.array([tools.radius])
        words = "the radii of the template differ; give PowerRange(..., radius=)"
        refuse_if((radius != radius[0]).any(), words, key="tools")
        kit = Kit.of_range(tools, float(radius[0]))
        return kit, template.replaced(cap=kit.tools[0].cap)
    shapes = {} if tools is None or isinstance(tools, RadiusRange) else _listed(tools, template)
    kit = Kit(tuple(shapes))
    if len(set(shapes.values())) > 1:
        return kit, template
    ours = template if not shapes else template.replaced(cap=next(iter(shapes.values())))
    _refuse_several_caps(ours.cap)
    radii: Any = tools if not shapes else [tool.radius for tool in shapes]
    return Radii.given(radii, template), ours


def singles(choice: Choice, template: Surface) -> list[Surface]:
    """Return the template with each tool of a choice for all asperities; of a range, with some tools."""
    if isinstance(choice, Radii):
        return [template.replaced(radius=radius) for radius in choice.tried.tolist()]
    return [tool.on(template) for tool in choice.tools]


def pressed(choice: Choice, template: Surface, contact: Contact) -> tuple[Contact, Any]:
    """Return the law of one contact of the tools, and what its methods take as `radius` for each tool.

    With a choice of radii, these are the radii of the template.
    """
    surface = choice.surface(template) if isinstance(choice, Kit) else template
    law = contact.bound(surface)
    return law, law.summits(surface)


def _listed(tools: Any, template: Surface) -> dict[Tool, Cap]:
    """Return the different tools of a list, in order, with their caps; plain radii have the template's."""
    words = "must be a list of metafem.Tool or of radii [mm], a RadiusRange or a PowerRange"
    if isinstance(tools, (str, bytes)) or not isinstance(tools, (Sequence, np.ndarray)) or not len(tools):
        raise InvalidInput(words, key="tools", value=shown(tools))
    found: dict[Tool, Cap] = {}
    for i, given in enumerate(tools):
        tool = given
        if not isinstance(given, Tool):
            if isinstance(given, str) or not check.scalar(given):
                raise InvalidInput(words, key=f"tools[{i}]", value=shown(given))
            _refuse_several_caps(template.cap)
            tool = Tool(check.number(f"tools[{i}]", given, above=0.0), template.cap)
        found[tool] = tool.cap
    return found


def _refuse_several_caps(cap: Cap) -> None:
    words = "has caps that differ; one common cap is needed here, and the argument tools allows several"
    refuse_if(isinstance(cap, Caps), words, key="template.cap")


def default_contact(tools: Given | None) -> Contact:
    """Return the default contact law: `Hertz()` if all tools are spheres or paraboloids, or `Elastic()`."""
    if isinstance(tools, PowerRange):
        return Elastic()
    listed: Any = () if tools is None or isinstance(tools, RadiusRange) else tools
    curved = (isinstance(tool.cap, (Sphere, Paraboloid)) for tool in listed if isinstance(tool, Tool))
    return PARABOLOID if all(curved) else Elastic()


def refuse_misfits(choice: Choice, template: Surface, top: float, law: Contact) -> None:
    """Raise InvalidInput for tools whose caps overlap or that a contact law does not describe.

    top: height of the tallest possible summit above the base plane [mm].
    """
    if isinstance(choice, Kit):
        for tool in choice.tools:
            _refuse_high_or_wide(tool, template, top)
    ranged = isinstance(choice, Kit) and choice.range is not None
    words = f"a range of exponents needs contacts without adhesion, not {law!r}; give a list of tools"
    refuse_if(ranged and law.adhesive, words, key="tools")
    refuse_curvature(choice, template, law)


def refuse_curvature(choice: Choice, template: Surface, law: Contact) -> None:
    """Raise InvalidInput if a law needs a curvature that summits lack, or another one than that of R."""
    whole = template if isinstance(choice, Radii) else choice.surface(template)
    summits = law.bound(whole).summits(whole)
    refuse_if(
        isinstance(choice, Radii) and not np.array_equal(summits, whole.radius),
        f"has another radius of curvature than R for {law!r}; use contact = Elastic(), or paraboloids with "
        "this radius",
        key="template.cap",
        value=repr(whole.cap),
    )


def _refuse_high_or_wide(tool: Tool, template: Surface, top: float) -> None:
    """Raise InvalidInput if caps of a tool cannot be `top` [mm] high, or then overlap on nearest sites."""
    radius, apart = np.array([tool.radius]), _least_distance(template)
    high = float(tool.cap.tallest(radius)[0])
    refuse_if(
        high < top,
        f"tools: {tool!r} has caps of at most {high:.4g} mm, but limits allow heights of {top:.4g} mm: use a "
        "larger radius or a smaller max_height",
    )
    wide = 2.0 * float(tool.cap.foot_radius(np.array([top]), radius)[0])
    refuse_if(
        wide > apart,
        f"tools: {tool!r} has a foot {wide:.4g} mm wide at the largest height of {top:.4g} mm, but the "
        f"nearest sites are {apart:.4g} mm apart: use a smaller radius, a larger coefficient, a smaller "
        "max_height or a larger pitch",
    )


def _least_distance(template: Surface) -> float:
    """Return the smallest distance of two sites [mm]; infinite for one site."""
    if template.count == 1:
        return np.inf
    distance, _ = scipy.spatial.cKDTree(template.position).query(template.position, k=2)
    return float(distance[:, 1].min())
