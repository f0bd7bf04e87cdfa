"""A contact law of soft caps from finite elements at large strain."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem.contact import TabulatedContact
from metafem.errors import refuse_if
from metafem.fe.axisymmetric.geometry import checked_cap
from metafem.fe.large_strain.press import press_sequence
from metafem.material import Material
from metafem.substrate import BondedLayer


def tabulated_contact(
    contact_radius: ArrayLike,
    radius: float,
    *,
    height: float,
    thickness: float,
    block_radius: float,
    material: Material,
) -> TabulatedContact:
    """Return the contact law of a soft spherical cap at large strain, from `press_finite`.

    The plane slips on the cap. As in all contact laws, the indentation is that of the cap on a half-space: on
    a block of this thickness it is smaller by ``-P self_influence`` of `BondedLayer`, which coupled models
    add. The law includes the compliance of the pedestal. It takes about 6 s per contact radius; the load is
    within 0.2 % where the mesh resolves the contact (`FiniteContact.error_estimate`).

    Parameters
    ----------
    contact_radius : array_like, (m,)
        Increasing contact radii [mm] of the table, at least 3, below the radius of the cap's base.
    radius, height : float
        Radius of the sphere and height of its cap [mm], the height up to the radius.
    thickness, block_radius : float
        Thickness and radius of the block [mm].
    material : Material
        Incompressible; its E* scales the loads.

    Returns
    -------
    TabulatedContact

    Raises
    ------
    InvalidInput
        If a size does not fit the others, or the material is compressible.
    NotConverged
        If a contact does not converge.

    Examples
    --------
    >>> law = tabulated_contact(
    ...     [0.1, 0.2, 0.26], 0.526, height=0.2, thickness=7.2, block_radius=10.0, material=Material(1.36)
    ... )
    >>> round(float(law.table[1, -1]) / (1.36 * 4 / 3 * 0.26**3 / 0.526), 3)
    0.977
    """
    radii = check.array("contact_radius", contact_radius, shape=(None,), positive=True)
    check.instance("material", material, Material, "a metafem.Material")
    refuse_if(
        material.poisson_ratio != 0.5,
        f"material = {material!r} must have poisson_ratio = 0.5: at large strain the finite elements are "
        "incompressible",
    )
    refuse_if(not (np.diff(radii) > 0.0).all(), "contact_radius must increase")
    cap = checked_cap(float(radii[-1]), radius, height, thickness, "block_radius", block_radius)
    contacts = press_sequence(radii, cap, stick=False)
    load = np.array([contact.rescaled_load for contact in contacts])
    sunk = -BondedLayer(cap.thickness, 0.5).self_influence * load
    indentation = np.array([contact.indentation for contact in contacts]) + sunk
    return TabulatedContact(indentation, material.composite_modulus * load, math.pi * radii**2)
