"""Design of a surface for a target law: `design` and its result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem import drawing
from metafem._calls import checked_call
from metafem._validate import IntArray
from metafem._values import Value, span
from metafem.errors import Infeasible, InvalidInput
from metafem.inversion import feasibility
from metafem.inversion.assessment import (
    DesignStatus,
    branch_fits,
    found_parameters,
    largest_misfit,
    misfit_meaning,
    status_of,
)
from metafem.inversion.candidate import Blueprint, Branch, Parameter
from metafem.inversion.design_notes import design_notes
from metafem.inversion.height_density import PiecewiseExponential
from metafem.inversion.height_steps import rounded_to_steps
from metafem.inversion.limits import Limits
from metafem.inversion.picture import draw_laws
from metafem.inversion.placement.layout import Layout, arranged
from metafem.inversion.problem import Request
from metafem.inversion.radii import Radii, RadiusRange
from metafem.inversion.refinement import interaction_margin, refined_surface
from metafem.inversion.strategies import exponential, operating_points, proportional, sampled
from metafem.inversion.strategies.mixture import Mixture
from metafem.inversion.targets.laws import (
    BilinearLaw,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
    Target,
)
from metafem.inversion.targets.wanted import Wanted
from metafem.models import Model
from metafem.notes import Note, counted, late_notes, when_read
from metafem.prediction import BranchFit, FrictionLaw, friction_law
from metafem.progress import doing
from metafem.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class Design(Value):
    """A surface designed for a target, with its predicted law.

    Attributes
    ----------
    surface : Surface
        The asperities that exist.
    law : FrictionLaw
        Law of the surface under the model of the design.
    misfit : float
        Relative deviation of the law from the target [-]. For operating points and lines over a load range
        it is the largest at any load. Otherwise it is the root mean square over the loads of the target, or
        the largest deviation of a fitted slope of a straight branch if that is larger. `misfit_meaning`
        says which it is.
    status : DesignStatus
    parameters : mapping
        What the inversion solved for, read-only: ``scale`` [mm], ``weight``, ``crossover_height`` [mm],
        ``counts``, ``levels`` [mm], ...
    sites : ndarray of int, (n,)
        Sites of the asperities in the template, read-only.
    target, template, limits
        The arguments of the design.
    fits : tuple of (Branch, BranchFit)
        Straight branches of the target, each with the fit of the law.
    radii : RadiusRange, tuple of float or None
        Radii that each asperity could have [mm]; None for one common radius.
    density : PiecewiseExponential or None
        The height density behind the heights, measured from `limits.foot`.
    notes : tuple of Note
        Limits of the design and of its model that matter for making the part.
    layout : Layout or None
        The layout for which the sites were chosen.

    Notes
    -----
    Designs are equal if all their members are, arrays to the bit; ``mf.load(folder) == design`` is True.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> mf.design(mf.LinearLaw(6.87), template)
    Design: Linear friction law of slope 6.87
      status      approximate: the density has the target's slopes at large loads; the law has the misfit
      misfit      2.8 %, difference of a fitted slope from the target's
      asperities  64 on 64 sites
      heights     0.0002997 to 0.1148 mm
      radius      0.526 mm
      model       Independent()
      law         100 loads 0.006527 to 0.6527 N, area 0.06483 to 3.559 mm^2
      parameters  scale, intercept, foot_load
      notes       1 note
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
    notes: tuple[Note, ...] = late_notes()
    radii: RadiusRange | tuple[float, ...] | None = None
    layout: Layout | None = None

    def __post_init__(self) -> None:
        count = self.surface.count
        if self.sites.shape != (count,) or len(np.unique(self.sites)) != count:
            raise InvalidInput(f"sites must hold {count} different sites, one for each asperity")
        if self.sites.min() < 0 or self.sites.max() >= self.template.count:
            raise InvalidInput(f"sites must be from 0 to {self.template.count - 1}, as the template has them")
        if not np.array_equal(self.surface.position, self.template.position[self.sites]):
            raise InvalidInput("surface.position must be that of the template at the sites")
        if not self.misfit >= 0.0:
            raise InvalidInput(f"misfit = {self.misfit:g} must be at least 0")
        pair = self.surface.material, self.surface.friction
        if (self.law.material, self.law.friction) != pair:
            raise InvalidInput("law.material and law.friction must be those of the surface")
        for value in (self.sites, *self.parameters.values()):
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))

    def __reduce__(self) -> Any:
        # a mapping proxy cannot be pickled; the constructor makes a new one
        members = {field.name: getattr(self, field.name) for field in fields(self)}
        return _restored, ({**members, "parameters": dict(self.parameters)},)

    def __repr__(self) -> str:
        surface, law = self.surface, self.law
        return "\n".join(
            [
                f"Design: {self.target.title}",
                f"  status      {self.status.value}",
                f"  misfit      {100.0 * self.misfit:.2g} %, {self.misfit_meaning}",
                f"  asperities  {surface.count} on {self.template.count} sites",
                f"  heights     {span(surface.height, 'mm')}",
                f"  radius      {span(surface.radius, 'mm')}",
                f"  model       {law.model!r}",
                f"  law         {len(law.load)} loads {span(law.load, 'N')}, area {span(law.area, 'mm^2')}",
                f"  parameters  {', '.join(self.parameters)}",
                f"  notes       {counted(dict.fromkeys((*self.notes, *law.notes)))}",
            ]
        )

    @property
    def wanted(self) -> Wanted:
        """The law with which `misfit` compares: that of the height density, or else the target."""
        if self.density is None:
            return sampled.wanted_law(self.target)
        branches = tuple(branch for branch, _ in self.fits)
        return exponential.law_of(self.density, branches, Mixture.of(self.surface.radius))

    @property
    def misfit_meaning(self) -> str:
        """Definition of `misfit` for this design, in words."""
        return misfit_meaning(self.wanted.pointwise, self.density is not None, self.fits, self.misfit)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the achieved law beside the target, rescaled.

        A design with a height density is drawn beside the law of the density and straight lines with the
        slopes of the target, whose ranges are shaded.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; without it in a new figure of ``matplotlib.pyplot``.

        Returns
        -------
        matplotlib Axes

        Examples
        --------
        >>> import metafem as mf
        >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
        >>> ax = mf.design(mf.PowerLaw(1.1, (0.05, 0.2)), template).plot()
        >>> [text.get_text() for text in ax.get_legend().get_texts()]
        ['achieved', 'target']
        """
        ax = drawing.axes(ax)
        draw_laws(self, ax)
        return ax


def _restored(members: dict[str, Any]) -> Design:
    return Design(**members)


Inversion = Callable[[Any, Radii, int, Limits, np.random.Generator], Blueprint]


def _straight(density: Inversion) -> Inversion:
    """Return the inversion of a straight law: by its density, or the line itself over a range of loads."""

    def invert(
        target: LinearLaw | BilinearLaw, radii: Radii, count: int, limits: Limits, rng: np.random.Generator
    ) -> Blueprint:
        chosen = density if target.load_range is None else sampled.invert
        return chosen(target, radii, count, limits, rng)

    return invert


_INVERSIONS: dict[type, Inversion] = {
    OperatingPoints: operating_points.invert,
    LinearLaw: _straight(exponential.invert_linear),
    BilinearLaw: _straight(exponential.invert_bilinear),
    SampledLaw: sampled.invert,
    PowerLaw: sampled.invert,
    MultilinearLaw: sampled.invert,
}

# Targets whose bounds are checked before the inversion.
_REFUSALS: dict[type, Callable[[Any, Radii, int, Limits, float], None]] = {
    LinearLaw: proportional.refuse_line,
    BilinearLaw: proportional.refuse_line,
    SampledLaw: feasibility.refuse_sampled,
    PowerLaw: feasibility.refuse_power,
    MultilinearLaw: feasibility.refuse_multilinear,
}


@checked_call
def design(
    target: Target,
    template: Surface,
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
    layout: Layout | None = None,
) -> Design:
    """Find heights whose friction law is the target.

    Parameters
    ----------
    target : OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw or MultilinearLaw
        Linear and bilinear laws with a load range are met as lines through the origin. Without a load range
        the heights follow a density whose law has the target slopes and its own intercept.
    template : Surface
        Sites, common radius, material, friction and block. Its heights are used only for the default of
        `limits`.
    model : Model, optional
        Model under which the law is to meet the target; default: ``Independent()``. Under a model with
        interaction the heights of the independent inversion are refined by the Levenberg–Marquardt method
        with exact sensitivities.
    limits : Limits, optional
        Manufacturing limits; default: heights up to the tallest of the template. With a `height_step` all
        heights are on its levels, and the loss is stated in a note and in the parameters ``step_levels``
        [mm], ``step_counts`` and ``step_loss`` [-]. For a linear law of independent asperities the numbers
        on the levels are the integers nearest to those of the density.
    rng : int or numpy Generator
        Seed of the random assignment of heights to sites, and of the random restarts of the search.
    layout : Layout, optional
        Aim of the assignment of heights to sites, by `arrange` under the model and before any refinement.
        Its misfits are the parameters ``layout_before`` and ``layout_after`` [-]. Default: a random
        assignment.

    Returns
    -------
    Design

    Raises
    ------
    Infeasible
        If no surface within the limits has the law, or no heights that meet the points were found. The
        message states the reason, and the error holds the nearest target within the bounds.
    InvalidInput
        For arguments outside their range or of the wrong kind.

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
    return designed(Request.checked(target, template, None, model, limits, layout), check.generator(rng))


def designed(request: Request, generator: np.random.Generator) -> Design:
    """Return the design of a request."""
    target, template, solver, limits = request.target, request.template, request.model, request.limits
    _refuse_infeasible(request)
    deal = generator.permutation(template.count)
    with doing("inverting the law"):
        blueprint = _INVERSIONS[type(target)](target, request.radii, template.count, limits, generator)
    sites = deal[: len(blueprint.height)]
    order = np.argsort(sites)
    sites = sites[order]
    surface = template.replaced(
        position=template.position[sites],
        height=np.maximum(blueprint.height[order], limits.foot),  # not below the limit by rounding
        radius=blueprint.radius[order],
    )
    surface, placed, placing = arranged(surface, request.layout, solver, blueprint.wanted, generator)
    surface, sites, moved = refined_surface(request, surface, sites, blueprint, generator)
    stepped: dict[str, Parameter] = {}
    coupled = solver.couples
    if limits.height_step is not None and (coupled or not blueprint.stepped):
        surface, stepped, lost = rounded_to_steps(surface, solver, blueprint, limits)
        moved += lost
    parameters = found_parameters(surface, solver, blueprint, target, bool(moved))
    fits = branch_fits(surface, solver, blueprint)
    misfit = largest_misfit(surface, solver, blueprint, fits)
    status = status_of(solver, blueprint, misfit, bool(moved))
    law = _drawn_law(surface, request)
    loss = float(np.asarray(stepped.get("step_loss", 0.0)))
    told = design_notes(request, blueprint, surface, fits, misfit, status, loss)
    own = blueprint.notes + placing + moved + told
    return Design(
        surface=surface,
        law=law,
        misfit=misfit,
        status=status,
        parameters=parameters | placed | stepped,
        sites=sites,
        target=target,
        template=template,
        limits=limits,
        fits=fits,
        density=blueprint.density,
        notes=when_read(_with_those_of_the_law, own, law),
        layout=request.layout,
    )


def _with_those_of_the_law(own: tuple[Note, ...], law: FrictionLaw) -> tuple[Note, ...]:
    """Return a design's own notes and what its law's model leaves out, each once."""
    return tuple(dict.fromkeys((*own, *law.notes)))


def _refuse_infeasible(request: Request) -> None:
    """Raise Infeasible for a target beyond its bounds by more than the interaction margin of the model."""
    target, radii, count = request.target, request.radii, request.template.count
    refuse = _REFUSALS.get(type(target))
    if refuse is None:
        return
    try:
        refuse(target, radii, count, request.limits, 0.0)
    except Infeasible:
        margin = interaction_margin(request)
        if margin == 0.0:
            raise
        refuse(target, radii, count, request.limits, margin)


@doing("computing the law of the heights")
def _drawn_law(surface: Surface, request: Request) -> FrictionLaw:
    """Return the law on the default grid, or on one up to 1.1 times the last load of the target."""
    if request.target.last_load is None:
        return friction_law(surface, request.model)
    end = 1.1 * surface.material.composite_modulus * request.target.last_load
    return friction_law(surface, request.model, load=end * np.arange(1, 101) / 100)
