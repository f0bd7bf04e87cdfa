"""Radii as unknowns: the best common radius of a list of tools or a range, or one for each asperity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._calls import checked_call
from metafem._validate import FloatArray
from metafem.errors import Infeasible
from metafem.inversion.bounds import achievable_friction_coefficients
from metafem.inversion.candidate import Parameter
from metafem.inversion.design import Design, designed
from metafem.inversion.limits import Limits
from metafem.inversion.placement.layout import Layout
from metafem.inversion.problem import Request
from metafem.inversion.radii import Radii, RadiusRange
from metafem.inversion.strategies.mixture import unreachable
from metafem.inversion.targets.laws import Target
from metafem.models import Model
from metafem.notes import Note, information
from metafem.progress import each
from metafem.surface import Surface

# Radii of a range that are tried between the best one's neighbours.
NEXT_RADII = 4

# If more radii of a range than this are in use, only the least and the largest are stated.
MOST_LISTED = 8


@checked_call
def design_radius(
    target: Target,
    template: Surface,
    radii: RadiusRange | Sequence[float],
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
    layout: Layout | None = None,
) -> Design:
    """Find the common radius, and the heights, whose friction law is nearest to the target.

    Parameters
    ----------
    target, model, limits, rng
        As for `design`.
    template : Surface
        As for `design`; its radii are not used.
    radii : RadiusRange or sequence of float
        A range, of which up to 11 radii are tried, or a list of tool radii [mm].
    layout : Layout, optional
        As for `design`, for the best radius alone.

    Returns
    -------
    Design
        The design of the least misfit. Its parameters hold ``radius`` [mm] and, for all radii that can
        reach the target, ``tried_radii`` [mm] and ``radius_misfits`` [-] before any layout. With a
        template that has a friction they also hold the bounds of the friction coefficients of linear laws
        with each radius, ``lowest_coefficients`` and, where `limits.height_sd` is given,
        ``highest_coefficients``. A note lists the radii that cannot reach the target, with the reason.

    Raises
    ------
    Infeasible
        If no radius reaches the target, with the reasons for the smallest and the largest.
    InvalidInput
        For arguments that cannot be used.

    Examples
    --------
    A slope of 4.5 is out of reach of the larger tool.

    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> result = mf.design_radius(mf.LinearLaw(4.5), template, [0.526, 0.3])
    >>> result.parameters["radius"]
    0.3
    """
    request = Request.checked(target, template, [] if radii is None else radii, model, limits, layout)
    choice, bounds = request.radii, request.limits
    seed = check.generator(rng).integers(2**63)
    found: dict[float, Design] = {}
    refused: dict[float, Infeasible] = {}

    def found_with(radius: float, layout: Layout | None) -> Design:
        part = template.replaced(radius=radius)
        one = replace(request, template=part, radii=Radii.of(radius), layout=layout)
        return designed(one, np.random.default_rng(seed))

    def attempt(values: FloatArray) -> None:
        for radius in each("radius", values.tolist()):
            try:
                found[radius] = found_with(radius, None)
            except Infeasible as reason:
                refused[radius] = reason

    attempt(choice.tried)
    if not found:
        raise unreachable(refused)
    if choice.tools is None:
        attempt(_between(choice.tried, min(found, key=lambda radius: found[radius].misfit)))
    best = min(found, key=lambda radius: found[radius].misfit)
    result = found[best] if layout is None else found_with(best, layout)
    tried = np.array(sorted(found))
    parameters = {
        **result.parameters,
        "radius": best,
        "tried_radii": tried,
        "radius_misfits": np.array([found[radius].misfit for radius in tried.tolist()]),
    }
    if template.friction is not None:
        parameters |= _reach(template, bounds, tried)
    return replace(result, parameters=parameters, notes=result.notes + _notes(refused))


@checked_call
def design_radii(
    target: Target,
    template: Surface,
    radii: RadiusRange | Sequence[float],
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
    layout: Layout | None = None,
) -> Design:
    """Find a radius and a height for each asperity whose friction law is nearest to the target.

    One radius for all is used where it reaches the target. Otherwise radii are mixed. Linear and bilinear
    laws assign two radii to the heights of one density, whose law is that of the single radius
    ``R = (<R>/<sqrt R>)^2``. For operating points each level can have a different radius. For laws of any
    shape heights and radii are searched together. The radii are found for independent asperities; under
    another model only the heights are refined. With several radii the local exponent of a law can be below
    2/3, and its slope can be larger.

    Parameters
    ----------
    target, model, limits, rng, layout
        As for `design`.
    template : Surface
        As for `design`; its radii are not used.
    radii : RadiusRange or sequence of float
        Radii that each asperity may have: any of a range, or a list of tool radii [mm].

    Returns
    -------
    Design
        Its parameters hold the radii in use, ``used_radii`` [mm], and the number of asperities of each,
        ``radius_counts``; for a range ``lowest_radius`` and ``highest_radius`` [mm]. With a template that
        has a friction they also hold ``reachable_coefficients``, the lowest friction coefficient of linear
        laws and, where `limits.height_sd` is given, the highest, and ``lowest_coefficients`` and
        ``highest_coefficients`` for each of the ``tried_radii`` [mm] alone.

    Raises
    ------
    Infeasible
        If no radii reach the target, with the reason.
    InvalidInput
        For arguments that cannot be used.

    Examples
    --------
    With one radius the local exponent of a law is at least 2/3.

    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> target = mf.PowerLaw(0.64, (0.1, 0.2))
    >>> result = mf.design_radii(target, template, [0.2, 0.8], limits=mf.Limits(0.27))
    >>> result.parameters["used_radii"], result.misfit < 1e-3
    (array([0.2, 0.8]), True)
    """
    request = Request.checked(target, template, [] if radii is None else radii, model, limits, layout)
    result, choice = designed(request, check.generator(rng)), request.radii
    parameters = dict(result.parameters)
    used, counts = np.unique(result.surface.radius, return_counts=True)
    if choice.tools is None and len(used) > MOST_LISTED:
        parameters |= {"lowest_radius": float(used[0]), "highest_radius": float(used[-1])}
    else:
        parameters |= {"used_radii": used, "radius_counts": counts.astype(np.int64)}
    if template.friction is not None:
        reach = np.array(achievable_friction_coefficients(template, request.limits, radii))
        parameters |= {"tried_radii": choice.tried, **_reach(template, request.limits, choice.tried)}
        parameters["reachable_coefficients"] = reach[np.isfinite(reach)]
    kept = RadiusRange(choice.low, choice.high) if choice.tools is None else choice.tools
    return replace(result, parameters=parameters, radii=kept)


def _between(tried: FloatArray, best: float) -> FloatArray:
    """Return radii between the best one and its neighbours."""
    i = int(np.argmin(np.abs(tried - best)))
    low, high = tried[max(i - 1, 0)], tried[min(i + 1, len(tried) - 1)]
    sides = [np.geomspace(low, best, 2 + NEXT_RADII // 2), np.geomspace(best, high, 2 + NEXT_RADII // 2)]
    return np.concatenate([side[1:-1] for side in sides if side[0] < side[-1]])


def _reach(template: Surface, limits: Limits, radii: FloatArray) -> dict[str, Parameter]:
    """Return the friction coefficients of linear laws with each radius alone."""
    bounds = np.array(
        [achievable_friction_coefficients(template, limits, [radius]) for radius in radii.tolist()]
    )
    reach: dict[str, Parameter] = {"lowest_coefficients": bounds[:, 0]}
    if np.isfinite(bounds).all():
        reach["highest_coefficients"] = bounds[:, 1]
    return reach


def _notes(refused: dict[float, Infeasible]) -> tuple[Note, ...]:
    if not refused:
        return ()
    which = ", ".join(f"{radius:.4g}" for radius in sorted(refused))
    return (information(f"radii that cannot reach the target [mm]: {which}; {refused[min(refused)]}"),)
