"""Asperities that interact through the elastic block."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import checked_contact
from metafem.errors import InvalidInput
from metafem.models.adhesion.notes import adhesive_law
from metafem.models.curve import Curve, Sensitivity, areas_one_by_one, controlled
from metafem.models.interacting.adhesive import AdhesiveCoupling
from metafem.models.interacting.elastic import DENSE_LIMIT as DENSE_LIMIT
from metafem.models.interacting.elastic import LATTICE_LIMIT as LATTICE_LIMIT
from metafem.models.interacting.elastic import TOLERANCE as TOLERANCE
from metafem.models.interacting.elastic import ElasticCoupling
from metafem.substrate import HalfSpace, Substrate
from metafem.surface import Surface


@dataclass(frozen=True)
class Interacting:
    """Asperities coupled through an elastic substrate.

    The indentations are ``d_i = h_i - delta - u_i`` with the displacement ``u_i`` by the other asperities.
    Load and area of each contact follow from its law; for Hertz's, ``P_i = 4/3 E* sqrt(R_i) d_i^(3/2)``.

    Order 1 represents the other asperities by point loads, ``u_i = sum_j P_j/E* G(r_ij)``. Order 3 adds
    all three terms of the next order: the finite size of the sources, ``M_j/4 lap G`` with the second moment
    M of their pressure, for Hertz contacts ``a_j^2/10 lap G`` per load; the curvature of the field,
    ``sum_j P_j/E* lap G/2``, which adds to that of the summit; and its slope, which tilts the contact and
    for Hertz contacts shifts it by ``-R grad u``. They are the gradient of one energy, to first order in the
    shifts. For very flat contacts, with a slope D' at their edge below 0.005, D' = 0.005 is used in the tilt.
    Both orders include the regular self terms of the substrate.

    Against resolved contacts of paraboloids on a half-space, up to a/pitch = 0.32, the error of order 3 is at
    most 0.03 % in the total load at fixed approach and 0.25 % in A0 at fixed load (0.12 % for up to nine
    contacts); that of order 1 in A0 reaches 3 %. Of nine spheres or power caps, up to power 4, order 3 is off
    by at most 0.04 % in the load and 0.4 % in A0.
    On a bonded layer the error of order 3 in A0 is at most 0.2 % up to a/t = 0.3 with nu = 0.5, and less for
    smaller Poisson's ratios; it grows as (a/t)^5. The notes of a state or law warn where contacts overlap and
    where the estimated error of order 3 exceeds 4 % in A0, and state where a/r exceeds 0.32. Lengths are in
    mm, loads in N, moduli in MPa.

    Parameters
    ----------
    order : {1, 3}
    substrate : Substrate
        `HalfSpace()`, `BondedLayer()`, or any other.
    contact : Contact
        Law of one contact; default: `Hertz()`. Laws given only as P(d) and A(d) need order 1.
    pedestal : bool
        Add the compliance of the caps themselves in the limit of light loads; tabulated up to h/R = 0.6.

    Raises
    ------
    InvalidInput
        For an unknown order, or a substrate or contact that cannot be used. When solving: on a
        layer thinner than the contact radius.
    NotConverged
        When solving with `equilibrium`, `friction_law` and `Curve.checked`, if an equilibrium does not
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
    unloads: ClassVar[bool] = True

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
                f"order = {self.order} needs the profile of the contacts, which {self.contact!r} does not "
                "have; use order=1"
            )
        check.instance("pedestal", self.pedestal, bool, "True or False")

    @property
    def name(self) -> str:
        """Name of the model in texts, with its substrate and all non-default attributes."""
        # a user's substrate may have no name
        substrate = getattr(self.substrate, "name", type(self.substrate).__name__)
        order = "" if self.order == 3 else f", order {self.order}"
        law = "" if self.contact == PARABOLOID else f", {self.contact!r}"
        return f"{substrate}{order}{', with pedestals' if self.pedestal else ''}{law}"

    @property
    def gradient_model(self) -> Interacting:
        """The model itself."""
        return self

    @property
    def reference(self) -> Interacting:
        """The same model of the largest order that its contact law allows."""
        return replace(self, order=self.contact.largest_order)

    def bound(self, surface: Surface) -> ElasticCoupling | AdhesiveCoupling:
        """Return the asperities of a surface with their law and their influence on each other."""
        law = self.contact.for_material(surface.material)
        given = self, surface, law, self.substrate.for_surface(surface), self.order, self.pedestal
        return AdhesiveCoupling(*given) if adhesive_law(law) else ElasticCoupling(*given)

    def curve(
        self,
        surface: Surface,
        load: FloatArray | None = None,
        *,
        approach: FloatArray | None = None,
        unloading: bool = False,
    ) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,).

        unloading: the values are reached by unloading from the largest; adhesive loads may be negative.
        """
        values, by_load = controlled(load, approach)
        return self.bound(surface).path(values, by_load, unloading)

    def curves(
        self, surface: Surface, height: ArrayLike, rescaled_load: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Friction laws of many lists of heights on the sites of one surface, in compiled code.

        Parameters
        ----------
        surface : Surface
            Positions, radii, material and block; its own heights are not used.
        height : array_like, (m, n) or (n,)
            Lists of summit heights [mm].
        rescaled_load : array_like, (k,)
            Loads P/E* [mm^2], not negative, in any order.

        Returns
        -------
        approach, load, area, stiffness : ndarray, (m, k)
            Approach [mm], load recomputed at it [mm^2], real contact area [mm^2] and derivative of
            the rescaled load by the approach [mm].

        Raises
        ------
        InvalidInput
            For heights or loads outside their range, and a layer thinner than the contacts.
        NotConverged
            If a residual exceeds 1e-12 (1e-9 above 2000 asperities, and by order 3 above 400 on a lattice);
            all results are attached.

        Examples
        --------
        >>> from metafem import Material
        >>> surface = Surface([[0, 0], [1.5, 0]], [0.1, 0.1], 0.526, Material(1.36))
        >>> approach, load, area, stiffness = Interacting().curves(
        ...     surface, [[0.1, 0.1], [0.1, 0.2]], [0.01, 0.02]
        ... )
        >>> area.round(4)
        array([[0.0988, 0.1568],
               [0.0784, 0.1245]])
        """
        heights = check.lists("height", height, surface.count)
        loads = check.loads("rescaled_load", rescaled_load)
        order = np.argsort(loads, kind="stable")
        back = np.argsort(order, kind="stable")
        results = self.bound(surface).solve(heights, loads[order])
        approach, carried, area, stiffness = (part[:, back] for part in results)
        return approach, carried, area, stiffness

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads (k,), and dA0/dh of each height at fixed load [mm], (k, n).

        The contact system is solved once per load for all heights; above the size limit of the dense
        solver by conjugate gradients, to 1e-9.
        height: summit heights (n,) [mm] that replace those of the surface; they are not checked.
        """
        heights = surface.height if height is None else height
        return self.bound(surface).sensitivity(heights, load)

    def areas(
        self,
        surface: Surface,
        load: FloatArray,
        height: FloatArray,
        radius: FloatArray | None = None,
        position: FloatArray | None = None,
    ) -> FloatArray:
        """A0 [mm^2] at increasing rescaled loads (k,) for many surfaces, (m, k); nan if not converged.

        height, radius: (m, n) [mm]; position: (m, n, 2) [mm]; default: those of the surface. With varying
        positions, or varying radii above the size limit of the dense solver, surfaces are solved one by one.
        """
        if position is not None:
            return areas_one_by_one(self.curve, surface, load, height, radius, position)
        return self.bound(surface).areas(height, radius, load)
