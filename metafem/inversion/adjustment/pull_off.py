"""Surfaces with a prescribed pull-off force."""

from __future__ import annotations

from scipy.optimize import brentq

from metafem import _validate as check
from metafem.errors import Infeasible, refuse_if
from metafem.inversion.limits import Limits
from metafem.models import Model
from metafem.prediction import pull_off
from metafem.progress import doing
from metafem.surface import Surface

# Relative tolerance of the factor, and largest relative error of the force of a returned surface.
TOLERANCE, REACHED = 1e-12, 1e-6


@doing("scaling the heights")
def scaled_to_pull_off(
    surface: Surface, force: float, model: Model, *, load: float, limits: Limits | None = None
) -> Surface:
    """Return a surface whose height differences are scaled so that it has a given pull-off force.

    The tallest height and the positions are kept. Contacts of equal heights break together, with the largest
    force; the larger the differences, the fewer contacts adhere at the same time.

    Parameters
    ----------
    surface : Surface
        Surface whose pattern of heights is scaled; it must have two different heights.
    force : float
        Pull-off force [N], positive.
    model : Model
        Model with an adhesive contact law, as in `pull_off`.
    load : float
        Largest load before unloading [N].
    limits : Limits, optional
        The lowest allowed height limits the factor; default: heights of at least 0.

    Returns
    -------
    Surface

    Raises
    ------
    Infeasible
        If no allowed factor has this force; the message states the range of forces.
    InvalidInput
        If the heights are equal, a value is out of range, or the contacts do not adhere.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface([[0, 0], [1, 0]], [0.1, 0.099], 0.5, mf.Material(1.36))
    >>> model = mf.Independent(mf.JKR(9e-6))
    >>> found = scaled_to_pull_off(surface, 3.5e-5, model, load=0.01)
    >>> round(1e6 * mf.pull_off(found, model, load=0.01), 3)
    35.0
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    check.instance("limits", limits, Limits | None, "metafem.Limits")
    wanted = check.number("force", force, above=0.0)
    top, gap = float(surface.height.max()), surface.gap
    refuse_if(not gap.any(), "has equal heights; scaling needs two different heights", key="surface")
    foot = 0.0 if limits is None else limits.foot
    refuse_if(top <= foot, f"has its tallest height at {top:g} mm, not above {foot:g} mm", key="surface")
    most = (top - foot) / float(gap.max())

    def at(factor: float) -> Surface:
        return surface.replaced(height=top - factor * gap)

    def excess(factor: float) -> float:
        return pull_off(at(factor), model, load=load) - wanted

    high, low = excess(0.0), excess(most)
    if high * low > 0.0:
        ends = sorted((high + wanted, low + wanted))
        raise Infeasible(
            f"a pull-off force of {wanted:.4g} N is not reached by scaling these heights: their forces are "
            f"{ends[0]:.4g} to {ends[1]:.4g} N; use more asperities, another radius or another energy"
        )
    found = float(brentq(excess, 0.0, most, xtol=TOLERANCE * most, rtol=TOLERANCE))
    error = excess(found)
    if abs(error) > REACHED * wanted:
        raise Infeasible(
            f"the pull-off force jumps past {wanted:.4g} N, to {wanted + error:.4g} N, where an asperity no "
            "longer comes into contact; use a larger load"
        )
    return at(found)
