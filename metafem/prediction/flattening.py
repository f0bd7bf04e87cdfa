"""Surfaces that an earlier load has permanently flattened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.models import Independent, Model
from metafem.models.curve import Curve
from metafem.models.model import checked_model, contact_of, with_contact
from metafem.surface import Surface


def flattened(surface: Surface, model: Model | None = None, *, load: float) -> tuple[Surface, Model]:
    """Return the surface after permanent flattening by a load, and the model with its new contact law.

    The model computes the indentation of each asperity under the load. After unloading, the summit is lower
    by the residual loss of height of the contact law. The contact is then elastic up to the earlier
    indentation; beyond it, the law of first loading continues. Up to the earlier load, unloading and
    reloading follow the same law, which the returned surface and model predict. The returned contact law
    applies only to these asperities in this order. Its tables take 20 s for a thousand asperities. For an
    elastic law, surface and model are returned unchanged.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        Model with a `contact`, such as ``Independent(KogutEtsion(hardness=10.0))``; default: `Independent()`.
    load : float
        Largest load P [N] of the first loading, at least 0.

    Returns
    -------
    surface : Surface
        The surface with its heights after unloading.
    model : Model
        The model with a contact law for each asperity.

    Raises
    ------
    InvalidInput
        If the load is out of range.
    NotConverged
        If the residual exceeds the model's tolerance.

    Examples
    --------
    >>> import metafem as mf
    >>> material = mf.Material(1.36)
    >>> surface = Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=material)
    >>> model = Independent(mf.KogutEtsion(hardness=0.1))
    >>> after, second = flattened(surface, model, load=0.002)
    >>> (surface.height - after.height).round(5)
    array([0.     , 0.00316])
    >>> round(mf.equilibrium(surface, model, load=0.001).area, 5)
    0.01523
    >>> round(mf.equilibrium(after, second, load=0.001).area, 5)
    0.01765
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    solver = checked_model(Independent() if model is None else model)
    newtons = check.number("load", load, at_least=0.0)
    curve = solver.curve(surface, np.array([newtons / surface.material.composite_modulus])).checked()
    return flattened_by(surface, solver, curve.last.indentation)


def unloading_curve(
    surface: Surface, model: Model, load: FloatArray | None = None, approach: FloatArray | None = None
) -> tuple[Surface, Model, Curve]:
    """Return the surface flattened by the largest load, its model, and its states on unloading.

    The states are those at rescaled loads [mm^2] or approaches [mm]. The contacts must not adhere. All
    approaches refer to the surface before flattening.
    """
    first = model.curve(
        surface,
        load if load is None else load[-1:],
        approach=approach if approach is None else approach[-1:],
    )
    refuse_if(
        not first.checked().load[0] > 0.0,
        "unloading = True: no asperity is in contact at the largest load; unloading begins there, and it "
        "must be greater than 0 N",
    )
    after, second = flattened_by(surface, model, first.last.indentation)
    lowered = float(surface.height.max() - after.height.max())
    curve = second.curve(after, load, approach=approach if approach is None else approach - lowered)
    return after, second, replace(curve, approach=curve.approach + lowered)


def flattened_by(surface: Surface, model: Model, indentation: FloatArray) -> tuple[Surface, Model]:
    """Return surface and model after indentations (n,) [mm]; an elastic law leaves both unchanged."""
    law = contact_of(model).bound(surface)
    after, loss = law.unloaded(indentation, law.summits(surface))
    if after is law:
        return surface, model
    return surface.replaced(height=surface.height - loss), with_contact(model, after)
