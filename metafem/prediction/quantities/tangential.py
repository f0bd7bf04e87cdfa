"""Tangential stiffness of sticking contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from metafem._validate import FloatArray
from metafem.material import Material
from metafem.models import Model
from metafem.prediction.quantities.given import given
from metafem.surface import Surface


def shear_modulus(material: Material) -> float:
    """Return ``G* = G/(2 - nu) = E* (1 - nu)/(2 (2 - nu))`` of a block against a rigid plane [MPa]."""
    ratio = material.poisson_ratio
    return material.composite_modulus * (1.0 - ratio) / (2.0 * (2.0 - ratio))


def tangential_stiffness(surface: Surface, model: Model | None = None, *, load: ArrayLike) -> FloatArray:
    """Return the tangential stiffness ``8 G* sum a_i`` of a surface whose contacts all stick.

    ``G* = E* (1 - nu)/(2 (2 - nu))`` against a rigid plane. The contact radii are those of the model. The
    tangential displacements by other contacts are left out, as in `onset`: the stiffness of interacting
    contacts is smaller. Mindlin, J. Appl. Mech. 16, 259 (1949), doi:10.1115/1.4009973.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        Model of the normal contact; default: `Independent()`.
    load : array_like, (k,)
        Normal loads P [N], at least 0; they are sorted.

    Returns
    -------
    ndarray, (k,)
        Tangential stiffness [N/mm] at increasing loads.

    Raises
    ------
    InvalidInput
        If a load is out of range.
    NotConverged
        If a residual exceeds the model's tolerance.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36, 0.5))
    >>> tangential_stiffness(surface, load=[0.1, 0.2]).round(3)
    array([1.404, 1.769])
    """
    solver, loads = given(surface, model, load)
    return np.asarray(
        8.0 * shear_modulus(surface.material) * contact_radii(solver, surface, loads).sum(axis=1)
    )


def contact_radii(model: Model, surface: Surface, rescaled_load: FloatArray) -> FloatArray:
    """Return the contact radii [mm] at rescaled loads (k,) [mm^2], (k, n)."""
    areas = [model.curve(surface, np.array([load])).checked().last.area for load in rescaled_load.tolist()]
    return np.sqrt(np.reshape(areas, (len(rescaled_load), surface.count)) / np.pi)
