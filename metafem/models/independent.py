"""Independent asperities: contacts without interaction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import checked_contact
from metafem.models.adhesion.curves import AdhesiveAsperities, adhesive_law
from metafem.models.curve import Curve, Sensitivity, controlled
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
class Independent:
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
    unloads: ClassVar[bool] = True

    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        checked_contact(self.contact)

    def __repr__(self) -> str:
        """Return the constructor's call; the default law is omitted."""
        return f"Independent({'' if self.contact == PARABOLOID else f'contact={self.contact!r}'})"

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``, with its contact law unless this is Hertz's."""
        return "independent" if self.contact == PARABOLOID else f"independent, {self.contact!r}"

    @property
    def gradient_model(self) -> Self:
        """The model itself."""
        return self

    @property
    def reference(self) -> Interacting:
        """`Interacting` with the same law on a half-space, of the highest order that the law supports."""
        return Interacting(self.contact.largest_order, contact=self.contact)

    def _equation(self, surface: Surface) -> LoadEquation:
        return load_equation(self.contact.bound(surface), self, surface)

    def curve(
        self,
        surface: Surface,
        load: FloatArray | None = None,
        *,
        approach: FloatArray | None = None,
        unloading: bool = False,
    ) -> Curve:
        """Return equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,).

        unloading: whether the values are reached by unloading from the largest one; loads may then be
        negative if the contacts adhere.
        """
        values, by_load = controlled(load, approach)
        return self._equation(surface).path(values, by_load, unloading)

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Return the law at increasing rescaled loads (k,), and dA0/dh at fixed load [mm], (k, n).

        ``dA0/dh_i = A'_i - P'_i sum_j A'_j / sum_j P'_j`` for asperities in contact, where A' and P' are
        derivatives with respect to the indentation. For Hertz contacts this is
        ``pi R_i - sum_j pi R_j sqrt(R_i d_i) / sum_j sqrt(R_j d_j)``. If the asperities differ in friction,
        the derivatives are those of ``sum_i w_i A_i``, and each A' has the factor w.
        height: summit heights (n,) [mm] that replace the heights of the surface; they are not checked.
        """
        heights = surface.height if height is None else height
        return self._equation(surface).sensitivity(heights, load)

    def areas(
        self, surface: Surface, load: FloatArray, height: FloatArray, radius: Any = None, position: Any = None
    ) -> FloatArray:
        """Return A0 [mm^2] of many surfaces at increasing rescaled loads (k,), (m, k); see `Model.areas`.

        height, radius: (m, n) [mm]; default: the surface's. Positions have no effect.
        """
        return self._equation(surface).areas(height, radius, load)

    def curve_of(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Curve:
        """Return the curve at increasing loads (k,) for unchecked heights and radii (n,)."""
        return load_equation(self.contact, self).curve(height, load, radius)

    def sensitivity_of(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the sensitivity at increasing loads (k,) for unchecked heights and radii (n,)."""
        return load_equation(self.contact, self).sensitivity(height, load, radius)
