"""Pull-off force of adhesive surfaces."""

from __future__ import annotations

from typing import Any, cast

from metafem import _validate as check
from metafem.errors import refuse_if
from metafem.models import Model
from metafem.models.model import contact_of
from metafem.prediction.friction_law import default_loads
from metafem.prediction.quantities.given import given
from metafem.surface import Surface


def pull_off(surface: Surface, model: Model, *, load: float | None = None) -> float:
    """Return the pull-off force of an adhesive surface: the largest tension on the way back from a load.

    The path consists of stable equilibria, of which each contact breaks at the end of its branch. A single
    JKR contact has the pull-off force ``3/2 pi w R``; equal independent contacts have n times this force, and
    contacts of different heights less, because they do not break together.

    Parameters
    ----------
    surface : Surface
    model : Model
        Model with an adhesive contact law, such as ``Independent(JKR(w))``.
    load : float, optional
        Largest load before unloading [N], positive: asperities that have not been in contact under it do not
        adhere. Default: the largest load of the default grid of `friction_law`.

    Returns
    -------
    float
        Pull-off force [N], positive in tension; 0 if no equilibrium on the path is in tension.

    Raises
    ------
    InvalidInput
        If the contacts of the model do not adhere, or the load is out of range.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = Surface([[0, 0]], [0.1], 0.5, mf.Material(1.36))
    >>> round(1e6 * pull_off(surface, mf.Independent(mf.JKR(9e-6)), load=0.01), 3)
    21.206
    """
    solver, _ = given(surface, model, [0.0])
    law = contact_of(solver).bound(surface)
    refuse_if(
        not law.adhesive or not hasattr(solver, "pull_off"),
        f"the model {solver.name} has no pull-off force: its contacts do not adhere; use a model such as "
        "metafem.Independent(metafem.JKR(adhesion_energy))",
    )
    modulus = surface.material.composite_modulus
    if load is None:
        largest = float(default_loads(surface, solver)[-1])
    else:
        largest = check.number("load", load, above=0.0) / modulus
    return modulus * float(cast("Any", solver).pull_off(surface, largest))
