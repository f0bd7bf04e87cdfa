"""The common radius as an unknown: the best of a workshop's tools, or of a range."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import Infeasible, InvalidInput
from metafem.inversion.arranged import Layout
from metafem.inversion.blueprint import Parameter
from metafem.inversion.bounds import achievable_friction_coefficients
from metafem.inversion.design import Design, design
from metafem.inversion.limits import Limits
from metafem.inversion.target import Target
from metafem.models import Model
from metafem.surface import Surface

# Radii of a range that are tried first, evenly in the logarithm, and then between the best one's
# neighbours.
FIRST_RADII, NEXT_RADII = 7, 4


@dataclass(frozen=True)
class RadiusRange:
    """Radii from one to another [mm], positive and increasing.

    Examples
    --------
    >>> RadiusRange(0.2, 0.8).high
    0.8
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", check.number("low", self.low, above=0.0))
        object.__setattr__(self, "high", check.number("high", self.high, above=self.low))


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
        A range, of which 11 radii are tried, or the tools of the workshop [mm].
    layout : Layout, optional
        As for `design`, for the best radius alone.

    Returns
    -------
    Design
        That of the least misfit. Its parameters hold ``radius`` [mm], ``tried_radii`` [mm] and
        ``radius_misfits`` [-] of those that can reach the target, and of a template with a friction the
        friction coefficients of linear laws within reach with each, ``lowest_coefficients`` and, where
        `limits.height_sd` bounds them, ``highest_coefficients``. A note says which cannot, and why.

    Raises
    ------
    Infeasible
        If no radius reaches the target; says why for the smallest and the largest.
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
    check.instance("template", template, Surface, "a metafem.Surface")
    bounds = Limits(max_height=float(template.height.max())) if limits is None else limits
    check.instance("limits", bounds, Limits, "metafem.Limits")
    ranged = isinstance(radii, RadiusRange)
    if isinstance(radii, RadiusRange):
        first = np.geomspace(radii.low, radii.high, FIRST_RADII)
    else:
        first = np.unique(check.array("radii", radii, shape=(None,)))
        if first[0] <= 0.0:
            raise InvalidInput(f"radii holds {first[0]:g}; all must be greater than 0")
    seed = check.generator(rng).integers(2**63)
    found: dict[float, Design] = {}
    refused: dict[float, Infeasible] = {}

    def attempt(values: FloatArray) -> None:
        for radius in values.tolist():
            part = template.replaced(radius=radius)
            try:
                found[radius] = design(target, part, model, bounds, np.random.default_rng(seed))
            except Infeasible as reason:
                refused[radius] = reason

    attempt(first)
    if not found:
        raise _unreachable(refused)
    if ranged:
        attempt(_between(first, min(found, key=lambda radius: found[radius].misfit)))
    best = min(found, key=lambda radius: found[radius].misfit)
    result = found[best]
    if layout is not None:
        part = template.replaced(radius=best)
        result = design(target, part, model, bounds, np.random.default_rng(seed), layout)
    parameters = {**result.parameters, "radius": best, **_reach(template, bounds, found)}
    return replace(result, parameters=parameters, notes=result.notes + _notes(refused))


def _between(tried: FloatArray, best: float) -> FloatArray:
    """Return radii between the best one and its neighbours."""
    i = int(np.argmin(np.abs(tried - best)))
    low, high = tried[max(i - 1, 0)], tried[min(i + 1, len(tried) - 1)]
    sides = [np.geomspace(low, best, 2 + NEXT_RADII // 2), np.geomspace(best, high, 2 + NEXT_RADII // 2)]
    return np.concatenate([side[1:-1] for side in sides if side[0] < side[-1]])


def _reach(template: Surface, limits: Limits, found: dict[float, Design]) -> dict[str, Parameter]:
    """Return the radii that reach the target, how well, and the friction coefficients of each."""
    radii = sorted(found)
    reach: dict[str, Parameter] = {
        "tried_radii": np.array(radii),
        "radius_misfits": np.array([found[radius].misfit for radius in radii]),
    }
    if template.friction is None:
        return reach
    bounds = np.array(
        [achievable_friction_coefficients(template.replaced(radius=radius), limits) for radius in radii]
    )
    reach["lowest_coefficients"] = bounds[:, 0]
    if np.isfinite(bounds).all():
        reach["highest_coefficients"] = bounds[:, 1]
    return reach


def _notes(refused: dict[float, Infeasible]) -> tuple[str, ...]:
    if not refused:
        return ()
    which = ", ".join(f"{radius:.4g}" for radius in sorted(refused))
    return (f"radii that cannot reach the target [mm]: {which}; {refused[min(refused)]}",)


def _unreachable(refused: dict[float, Infeasible]) -> Infeasible:
    smallest, largest = min(refused), max(refused)
    reasons = [f"with a radius of {radius:.4g} mm, {refused[radius]}" for radius in {smallest, largest}]
    nearest = refused[smallest].nearest
    return Infeasible(f"no radius reaches the target: {'; '.join(sorted(reasons))}", nearest)
