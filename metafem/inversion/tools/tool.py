"""One tool: a cap with its radius."""

from __future__ import annotations

from dataclasses import dataclass

from metafem import _validate as check
from metafem.caps import SPHERE, Cap, Caps
from metafem.errors import InvalidInput
from metafem.surface import Surface


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

    def on(self, template: Surface) -> Surface:
        """Return the template with all its asperities made by this tool."""
        return template.replaced(radius=self.radius, cap=self.cap)
