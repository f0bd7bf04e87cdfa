"""The one entry from a wanted law to a surface."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import IntArray
from metafem.distributions import PiecewiseExponential
from metafem.errors import InvalidInput
from metafem.inversion import exponential, operating_points
from metafem.inversion.blueprint import Blueprint, Branch, Parameter
from metafem.inversion.bounds import common_radius
from metafem.inversion.limits import Limits
from metafem.inversion.target import BilinearLaw, LinearLaw, OperatingPoints, Target
from metafem.law import BranchFit, FrictionLaw, friction_law
from metafem.models import Independent, Model
from metafem.surface import Surface

# Promise of an exact design: relative error of the friction at each operating point.
EXACT = 1e-9

# A straight branch further off than this has missed its target; the source paper counts 10 % on its
# crossover load, the loosest of its comparisons, as a success.
MISSED = 0.1

# Points on a straight branch when its slope is judged.
BRANCH_POINTS = 76

# Separations at which a law is compared with that of its density: a few hundred within each branch.
DENSITY_POINTS = 1001

# Heights should be this many times larger than the errors with which they are made.
HEIGHT_TO_ERROR = 10.0


class DesignStatus(Enum):
    """How a design ended; the value is the message."""

    EXACT = "exact: the law meets the target to 1e-9"
    APPROXIMATE = "approximate: the density has the target's slopes at large loads; the law has the misfit"
    MISSED = "missed: the law of so many asperities is further from the target than 10 %"
    UNCORRECTED = "uncorrected: designed for independent asperities; this model's law has the misfit"


@dataclass(frozen=True, eq=False)
class Design:
    """A surface designed for a target, with the law it will have.

    Attributes
    ----------
    surface : Surface
        The asperities that exist.
    law : FrictionLaw
        Their law under the chosen model.
    misfit : float
        Largest relative deviation of the law from what was asked for [-]: of the friction at operating
        points; of the fitted slopes of straight branches, and there of the friction, in the root mean
        square, from the law of the height density that has these slopes.
    status : DesignStatus
    parameters : mapping
        What the inversion solved for: ``scale`` [mm], ``weight``, ``crossover_height`` [mm],
        ``counts``, ``levels`` [mm], ...
    sites : ndarray of int, (n,)
        Places of the asperities in the template.
    target, template, limits
        What was asked for.
    fits : tuple of (Branch, BranchFit)
        Straight branches asked for and found.
    density : PiecewiseExponential or None
        The height density behind the heights, measured from `limits.foot`.
    notes : tuple of str
        What a user should know before making the part.
    """

    surface: Surface
    law: FrictionLaw
    misfit: float
    status: DesignStatus
    parameters: Mapping[str, Parameter]
    sites: IntArray
    target: Target
    template: Surface
    limits: Limits
    fits: tuple[tuple[Branch, BranchFit], ...] = ()
    density: PiecewiseExponential | None = None
    notes: tuple[str, ...] = ()


_INVERSIONS: dict[type, Callable[[Any, float, int, Limits], Blueprint]] = {
    OperatingPoints: operating_points.invert,
    LinearLaw: exponential.invert_linear,
    BilinearLaw: exponential.invert_bilinear,
}


def design(
    target: Target,
    template: Surface,
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
) -> Design:
    """Find heights whose friction law is the target.

    Parameters
    ----------
    target : OperatingPoints, LinearLaw or BilinearLaw
    template : Surface
        Places, common radius, material, friction and block; its heights are not used, but for the
        tallest where `limits` is left out.
    model : Model, optional
        Model of the predicted law, `Independent()` unless told.
    limits : Limits, optional
        What the workshop can make; without it, heights up to the template's tallest.
    rng : int or numpy Generator
        Seed of the deal of heights to places.

    Returns
    -------
    Design

    Raises
    ------
    Infeasible
        If no surface within the limits has the law; says why, with the nearest reachable target.
    InvalidInput
        For arguments that cannot be used.

    Notes
    -----
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, equations S1 to S8.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> result = mf.design(mf.LinearLaw(6.87), template)
    >>> round(result.parameters["scale"], 4), result.misfit < 0.03
    (0.0401, True)
    """
    solver: Model = Independent() if model is None else model
    if type(target) not in _INVERSIONS:
        known = ", ".join(kind.__name__ for kind in _INVERSIONS)
        raise InvalidInput(f"target = {target!r:.60} must be one of {known}")
    check.instance("template", template, Surface, "a metafem.Surface")
    check.instance("model", solver, Model, "a model such as metafem.Independent()")
    if limits is None:
        limits = Limits(max_height=float(template.height.max()))
    else:
        check.instance("limits", limits, Limits, "metafem.Limits")
    blueprint = _INVERSIONS[type(target)](target, common_radius(template), template.count, limits)
    sites = check.generator(rng).permutation(template.count)[: len(blueprint.height)]
    order = np.argsort(sites)
    sites = sites[order]
    sites.flags.writeable = False
    surface = template.replaced(
        position=template.position[sites],
        height=blueprint.height[order],
        radius=template.radius[sites],
    )
    fits = _fits(surface, solver, blueprint.branches)
    misfit = max(
        [abs(fit.slope / branch.slope - 1.0) for branch, fit in fits]
        + _density_errors(surface, solver, blueprint)
        + _point_errors(surface, solver, target)
    )
    return Design(
        surface=surface,
        law=_drawn_law(surface, solver, target),
        misfit=misfit,
        status=_status(solver, blueprint, misfit),
        parameters=blueprint.parameters,
        sites=sites,
        target=target,
        template=template,
        limits=limits,
        fits=fits,
        density=blueprint.density,
        notes=blueprint.notes + _notes(surface, limits),
    )


def _fits(
    surface: Surface, model: Model, branches: tuple[Branch, ...]
) -> tuple[tuple[Branch, BranchFit], ...]:
    modulus = surface.material.composite_modulus
    found = []
    for branch in branches:
        load = modulus * np.linspace(*branch.load_range, BRANCH_POINTS)
        found.append((branch, friction_law(surface, model, load=load).fit(branch.load_range)))
    return tuple(found)


def _density_errors(surface: Surface, model: Model, blueprint: Blueprint) -> list[float]:
    """Return the rms relative difference from the density's law over each branch."""
    if blueprint.density is None:
        return []
    density, count, radius = blueprint.density, surface.count, float(surface.radius[0])
    separation = density.max_height * (1.0 - np.arange(DENSITY_POINTS) / (DENSITY_POINTS - 1))
    load = density.rescaled_load(separation, count, radius)
    area = density.area(separation, count, radius)
    errors = []
    for branch in blueprint.branches:
        inside = (load >= branch.load_range[0]) & (load <= branch.load_range[1])
        found = friction_law(surface, model, load=surface.material.composite_modulus * load[inside]).area
        errors.append(float(np.sqrt(((found / area[inside] - 1.0) ** 2).mean())))
    return errors


def _point_errors(surface: Surface, model: Model, target: Target) -> list[float]:
    if not isinstance(target, OperatingPoints):
        return []
    load = surface.material.composite_modulus * target.rescaled_load
    area = friction_law(surface, model, load=load).area
    return [float(np.abs(area / target.rescaled_friction - 1.0).max())]


def _drawn_law(surface: Surface, model: Model, target: Target) -> FrictionLaw:
    """Return the law on its usual grid, or on one that ends a tenth beyond the last operating point."""
    if not isinstance(target, OperatingPoints):
        return friction_law(surface, model)
    end = 1.1 * surface.material.composite_modulus * float(target.rescaled_load[-1])
    return friction_law(surface, model, load=end * np.arange(1, 101) / 100)


def _status(model: Model, blueprint: Blueprint, misfit: float) -> DesignStatus:
    if not misfit <= MISSED:
        return DesignStatus.MISSED
    if not isinstance(model, Independent):
        return DesignStatus.UNCORRECTED
    if blueprint.branches:
        return DesignStatus.APPROXIMATE
    return DesignStatus.EXACT if misfit <= EXACT else DesignStatus.MISSED


def _notes(surface: Surface, limits: Limits) -> tuple[str, ...]:
    if limits.height_sd is None:
        return ()
    least = HEIGHT_TO_ERROR * limits.height_sd
    low = int((surface.height < least).sum())
    if not low:
        return ()
    return (
        f"{low} of {surface.count} summits stand lower than {HEIGHT_TO_ERROR:g} times height_sd = "
        f"{limits.height_sd:g} mm: raise the offset",
    )
