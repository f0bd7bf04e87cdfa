"""Independent asperities: contacts without interaction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import checked_contact
from metafem.models.adhesion.curves import AdhesiveAsperities, adhesive_law
from metafem.models.curve import Curve, Sensitivity, WithGradients
from metafem.models.interacting.model import Interacting
from metafem.models.load_equation import LoadEquation
from metafem.surface import Surface


def load_equation(law: Contact, model: object = None, surface: Surface | None = None) -> LoadEquation:
    """Return the load equation of a contact law, defined for unit E*; its states refer to `model`."""
    adhesive = adhesive_law(law)
    if adhesive is not None:
        return AdhesiveAsperities(model, adhesive, surface)
    return LoadEquation(model, law, surface)


@dataclass(frozen=True, repr=False)
class Independent(WithGradients):
    """Independent asperities under a common plane.

    ``A0 = sum A(d_i)`` and ``P/E* = sum P(d_i)/E*`` with ``d_i = max(h_i - delta, 0)``; for Hertz contacts
    ``A0 = sum pi R_i d_i`` and ``P/E* = sum 4/3 sqrt(R_i) d_i^(3/2)``. The load increases with the approach,
    and compiled kernels solve this equation by Newton's method within a bracket. Laws other than Hertz's are
    tabulated.
    Greenwood and Williamson, Proc. R. Soc. A 295, 300 (1966), doi:10.1098/rspa.1966.0242.

    Parameters
    ----------
    contact : Contact
        Law of one contact: `Hertz()` (default), `Elastic()`, `JKR(...)`, or any object with the methods of
        `metafem.contact.Contact` whose load increases with the indentation.

    Raises
    ------
    InvalidInput
        If `contact` is not a contact law.

    Examples
    --------
    >>> from metafem import Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (1, 1), radius=0.526, material=Material(1.36))
    >>> round(equilibrium(surface, Independent(), load=0.01).approach, 6)
    0.038668
    >>> from metafem import Elastic, Power
    >>> flat = surface.replaced(cap=Power(4))
    >>> round(equilibrium(flat, Independent(Elastic()), load=0.01).approach, 6)
    0.021002
    """

    couples: ClassVar[bool] = False

    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        checked_contact(self.contact)

    def __repr__(self) -> str:
        """Return the constructor's call; the default law is omitted."""
        return f"Independent({'' if self.contact == PARABOLOID else f'contact={self.contact!r}'})"

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``, with its contact law unless this is Hertz's."""
        return "independent" if self.contact == PARABOLOID else f"independent, {self.contact}"

    @property
    def reference(self) -> Interacting:
        """`Interacting` with the same law on a half-space, of the highest order that the law supports."""
        return Interacting(self.contact.largest_order, contact=self.contact)

    def bound(self, surface: Surface) -> LoadEquation:
        """Return the asperities of a surface with their law."""
        return load_equation(self.contact.bound(surface), self, surface)

    def curve_of(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Curve:
        """Return the curve at increasing loads (k,) for unchecked heights and radii (n,)."""
        return load_equation(self.contact, self).curve(height, load, radius)

    def sensitivity_of(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the sensitivity at increasing loads (k,) for unchecked heights and radii (n,)."""
        return load_equation(self.contact, self).sensitivity(height, load, radius)
