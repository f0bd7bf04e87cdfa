"""Difference of a surface's law from the target."""

from __future__ import annotations

from enum import Enum

import numpy as np

from metafem.inversion.candidate import Blueprint, Branch, Parameter
from metafem.inversion.strategies.sampled import open_parameters
from metafem.models import Independent, Model
from metafem.prediction import BranchFit, friction_law, law_at
from metafem.surface import Material, Surface

# Tolerance of an exact design: relative error of the friction at each load of the target.
EXACT = 1e-9

# A law of any shape counts as reached within this rms: manufacturing errors change the law by as much.
REACHED = 0.01

# A straight branch with few asperities misses its target beyond this misfit. Aymard et al. count 10 % on the
# crossover load, the largest difference in their comparisons, as a success.
MISSED = 0.1

# Number of loads at which the slope of a straight branch is fitted.
BRANCH_POINTS = 76


class DesignStatus(Enum):
    """How a design ended; the value is the message."""

    EXACT = "exact: the law meets the target to 1e-9"
    REACHED = "reached: the law meets the target within the misfit"
    REFINED = "refined: the heights were adjusted until the law met the target within the misfit"
    APPROXIMATE = "approximate: the density has the target's slopes at large loads; the law has the misfit"
    UNCORRECTED = "uncorrected: designed for independent asperities; this model's law has the misfit"
    MISSED = "missed: the misfit is above 1 %, or above 10 % for the heights of a density"


def found_parameters(
    surface: Surface, model: Model, blueprint: Blueprint, target: object, moved: bool
) -> dict[str, Parameter]:
    """Return the blueprint's parameters, updated to the final law and heights.

    Parameters that the target leaves open are fitted again. Levels are left out where heights were changed.
    """
    wanted = blueprint.wanted
    if blueprint.exact and moved:
        return {"span": float(np.ptp(surface.height))}
    parameters = dict(blueprint.parameters)
    if "span" in parameters:
        parameters["span"] = float(np.ptp(surface.height))
    if not wanted.free.shape[1]:
        return parameters
    area = friction_law(surface, model, load=surface.material.composite_modulus * wanted.load).area
    return {**parameters, **open_parameters(target, wanted, area)}


def branch_fits(surface: Surface, model: Model, blueprint: Blueprint) -> tuple[tuple[Branch, BranchFit], ...]:
    """Fit the law over each straight branch."""
    found = []
    for branch in blueprint.branches:
        load = np.linspace(*branch.load_range, BRANCH_POINTS)
        found.append((branch, law_at(surface, model, load).fit(branch.load_range)))
    return tuple(found)


def largest_misfit(
    surface: Surface, model: Model, blueprint: Blueprint, fits: tuple[tuple[Branch, BranchFit], ...]
) -> float:
    """Return the largest relative deviation, of the law from the target or of a fitted slope.

    Where the law is compared pointwise, the deviation of the law is its largest at any load, which bounds
    the slopes. Otherwise it is the root mean square.
    """
    wanted = blueprint.wanted
    area = friction_law(surface, model, load=surface.material.composite_modulus * wanted.load).area
    if wanted.pointwise:
        return float(np.abs(wanted.difference(area)).max())
    return max([wanted.misfit(area), worst_slope(fits)])


def misfit_meaning(
    pointwise: bool, density: bool, fits: tuple[tuple[Branch, BranchFit], ...], misfit: float
) -> str:
    """Return in words which of these deviations the misfit is."""
    if pointwise:
        return "largest difference from the target"
    if fits and misfit <= worst_slope(fits):
        return "difference of a fitted slope from the target's"
    return f"rms difference from {'the law of the height density' if density else 'the target'}"


def worst_slope(fits: tuple[tuple[Branch, BranchFit], ...]) -> float:
    """Return the largest relative deviation of a fitted slope; 0 without branches."""
    return max((abs(fit.slope / branch.slope - 1.0) for branch, fit in fits), default=0.0)


def independent_misfit(blueprint: Blueprint) -> float:
    """Return the misfit of independent asperities; it does not depend on the sites."""
    height, radius = blueprint.height, blueprint.radius
    surface = Surface.square_lattice(height, (1, len(height)), radius=radius, material=Material(1.0))
    model = Independent()
    return largest_misfit(surface, model, blueprint, branch_fits(surface, model, blueprint))


def status_of(model: Model, blueprint: Blueprint, misfit: float, moved: bool) -> DesignStatus:
    """Return how a design ended; a misfit of nan counts as missed."""
    if blueprint.density is None:
        if not misfit <= REACHED:
            return DesignStatus.MISSED
        if misfit <= EXACT:
            return DesignStatus.EXACT
        return DesignStatus.REFINED if moved else DesignStatus.REACHED
    if not misfit <= MISSED:
        return DesignStatus.MISSED
    if moved:
        return DesignStatus.REFINED
    return DesignStatus.APPROXIMATE if not model.couples else DesignStatus.UNCORRECTED
