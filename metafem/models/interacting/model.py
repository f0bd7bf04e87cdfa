"""Asperities that interact through the elastic block."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from metafem import _validate as check
from metafem.caps import SPHERE
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import checked_contact
from metafem.errors import InvalidInput, refuse_if
from metafem.models.adhesion.curves import AdhesiveAsperities, adhesive_law
from metafem.models.curve import WithGradients
from metafem.models.interacting.elastic import ElasticCoupling
from metafem.substrate import HalfSpace, Radial, Substrate
from metafem.surface import Surface


@dataclass(frozen=True)
class Interacting(WithGradients):
    """Asperities coupled through an elastic substrate.

    The indentations are ``d_i = h_i - delta - u_i``, where ``u_i`` is the displacement by the other
    asperities. Load and area of each contact follow from its law; for Hertz's law
    ``P_i = 4/3 E* sqrt(R_i) d_i^(3/2)``. Lengths are in mm, loads in N, moduli in MPa.

    Order 1 represents the other asperities by point loads, ``u_i = sum_j P_j/E* G(r_ij)``. Order 3 adds:

    - the finite size of the sources, ``M_j/4 lap G`` with the second moment M of their pressure, which is
      ``a_j^2/10 lap G`` per load for Hertz contacts;
    - the curvature of the field, ``sum_j P_j/E* lap G/2``, which is added to the curvature of the summit;
    - the slope of the field, which tilts the contact and shifts Hertz contacts by ``-R grad u``. It changes
      the areas of other caps by ``-2 (a D''/D' - 1) (g/D')^2``, with the slope g and the cap's indentation D.

    To first order in the shifts, these terms are the gradient of one energy. Both orders include the regular
    self terms of the substrate. The stiffness of a curve has a relative error below 1e-6.

    Errors are measured against resolved contacts. For paraboloids on a half-space, up to a/pitch = 0.32, the
    error of order 3 is at most 0.03 % in the total load at fixed approach, and 0.25 % in A0 at fixed load;
    that of order 1 in A0 reaches 3 %. For nine spheres or power caps with powers up to 4, order 3 is off by
    at most 0.04 % in the load and 0.15 % in A0. On a bonded layer with nu = 0.5, the error of order 3 in A0
    is at most 0.2 % up to a/t = 0.3, and increases as (a/t)^5. The notes of a state or law warn if contacts
    overlap, or if the estimated error of order 3 in A0 exceeds 4 %.

    If the surface has a periodic cell, all displacements are sums over the periods, including those of an
    asperity by its own images. On a half-space they are relative to their mean, so that the separation is
    measured from the mean plane of the deformed surface. Above 2000 asperities the sites must form a
    rectangular grid that divides the cell. Against finite elements of the unit cell of a square lattice, the
    load of order 3 at a given contact radius is off by at most 0.03 % up to a/pitch = 0.19.

    Parameters
    ----------
    order : {1, 3}
        Default: 3.
    substrate : Substrate
        `HalfSpace()` (default), `BondedLayer()`, or any other substrate.
    contact : Contact
        Default: `Hertz()`. Adhesive and plastic contacts, and tables of P(d) and A(d), need order 1.
    pedestal : bool
        Whether to add the compliance of spherical caps in the limit of light loads, tabulated up to
        h/R = 0.6; default: False.

    Raises
    ------
    InvalidInput
        If the order is unknown, or the substrate or contact cannot be used. When solving: if the layer is
        thinner than a contact radius, a contact is wider than the periodic cell, or the caps on pedestals are
        not spheres.
    NotConverged
        When solving with `equilibrium`, `friction_law` or `Curve.checked`: if an equilibrium does not
        converge to the tolerance.

    Examples
    --------
    >>> from metafem import Material, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, Interacting(), load=0.5)
    >>> round(state.area, 3), round(state.separation, 4)
    (3.461, 0.0431)
    """

    couples: ClassVar[bool] = True

    order: int = 3
    substrate: Substrate = field(default_factory=HalfSpace)
    contact: Contact = PARABOLOID
    pedestal: bool = False

    def __post_init__(self) -> None:
        integer = isinstance(self.order, int | np.integer) and not isinstance(self.order, bool)
        if not integer or self.order not in (1, 3):
            raise InvalidInput(f"order = {self.order!r} does not exist; it must be 1 or 3")
        check.instance("substrate", self.substrate, Substrate, "a substrate such as metafem.HalfSpace()")
        checked_contact(self.contact)
        if self.order > self.contact.largest_order:
            raise InvalidInput(
                f"order = {self.order} needs elastic contacts without adhesion, other than {self.contact}; "
                "use order=1"
            )
        check.instance("pedestal", self.pedestal, bool, "True or False")

    @property
    def name(self) -> str:
        """Name of the model in texts, with its substrate and all non-default attributes."""
        # a user's substrate may have no name
        substrate = getattr(self.substrate, "name", type(self.substrate).__name__)
        order = "" if self.order == 3 else f", order {self.order}"
        law = "" if self.contact == PARABOLOID else f", {self.contact}"
        return f"{substrate}{order}{', with pedestals' if self.pedestal else ''}{law}"

    @property
    def reference(self) -> Interacting:
        """The same model with the highest order that its contact law supports."""
        return replace(self, order=self.contact.largest_order)

    def bound(self, surface: Surface) -> ElasticCoupling | AdhesiveAsperities:
        """Return the asperities of a surface with their law and their influence on each other."""
        if surface.cell is not None and not isinstance(self.substrate, Radial):
            name = getattr(self.substrate, "name", type(self.substrate).__name__)
            raise InvalidInput(
                f"{type(self.substrate).__name__} ({name}) cannot have a periodic cell; use "
                "metafem.BondedLayer() or metafem.HalfSpace(), or a surface with cell=None"
            )
        refuse_if(
            self.pedestal and surface.cap != SPHERE,
            f"cannot be True with cap = {surface.cap!r}: the compliance of a cap is known for {SPHERE!r}; "
            "use pedestal=False",
            key="pedestal",
        )
        law = self.contact.bound(surface)
        bound = self.substrate.for_surface(surface)
        coupled = ElasticCoupling(self, surface, law, bound, self.order, self.pedestal)
        adhesive = adhesive_law(law)
        return coupled if adhesive is None else AdhesiveAsperities(self, adhesive, surface, coupled)
