"""One tool: a cap with its radius and its coating."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem.caps import SPHERE, Cap, Caps
from metafem.errors import InvalidInput
from metafem.surface import Surface


@dataclass(frozen=True, repr=False)
class Tool:
    """A tool of which every cap is a copy: a shape with its radius and, if it coats them, their friction.

    Parameters
    ----------
    radius : float
        R of the caps [mm], positive: of a sphere or a paraboloid, the radius of curvature; it scales the
        profiles of other caps.
    cap : Cap
        Shape of the caps; default: `Sphere()`.
    shear_strength : float, optional
        sigma [MPa] of the coated caps, positive; default: None, that of the template of the design. Their
        area ratio B is that of the template.

    Raises
    ------
    InvalidInput
        If the radius or the shear strength is not positive, or the cap is not a shape.

    Examples
    --------
    >>> import metafem as mf
    >>> Tool(0.3), Tool(0.8, mf.Power(4))
    (Tool(radius=0.3, cap=Sphere()), Tool(radius=0.8, cap=Power(exponent=4.0, coefficient=0.5)))
    >>> Tool(0.8, shear_strength=0.5)
    Tool(radius=0.8, cap=Sphere(), shear_strength=0.5)
    """

    radius: float
    cap: Cap = SPHERE
    shear_strength: float | None = None

    def __post_init__(self) -> None:
        check.member(self, "radius", above=0.0)
        check.member(self, "shear_strength", optional=True, above=0.0)
        if isinstance(self.cap, Caps) or not isinstance(self.cap, Cap):
            words = "must be one cap such as metafem.Sphere() or metafem.Power(4)"
            raise InvalidInput(words, key="cap", value=repr(self.cap))

    def on(self, template: Surface) -> Surface:
        """Return the template with all its asperities made by this tool."""
        changes: dict[str, Any] = {"radius": self.radius, "cap": self.cap}
        if self.shear_strength is not None and template.friction is not None:
            changes["friction"] = template.friction.coated(np.full(template.count, self.shear_strength))
        return template.replaced(**changes)

    def __repr__(self) -> str:
        """Return the constructor's call; a shear strength that is not given is omitted."""
        coating = "" if self.shear_strength is None else f", shear_strength={self.shear_strength!r}"
        return f"Tool(radius={self.radius!r}, cap={self.cap!r}{coating})"
