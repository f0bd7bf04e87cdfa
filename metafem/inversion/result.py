"""Result of a design."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from functools import cached_property, partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import drawing
from metafem._validate import FloatArray, IntArray
from metafem._values import Value, percent, span
from metafem.drawing import TARGET
from metafem.errors import refuse_if
from metafem.inversion.density import ExponentialDensity, law_of
from metafem.inversion.limits import Limits, Pinned
from metafem.inversion.problem import Branch, Parameter
from metafem.inversion.refinement import EXACT, MISSED, REACHED
from metafem.inversion.target_law import Target, TargetLaw
from metafem.inversion.tools import PowerRange, RadiusRange, Tool
from metafem.models.model import contact_of
from metafem.notes import Note, late, printed_count
from metafem.prediction import BranchFit, FrictionLaw
from metafem.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Name of the misfit under the next better model in notes.
DOUBT = "misfit under the next model"

# Number of digits that identify any double-precision number.
MOST_DIGITS = 17

# A plot marks the loads of a target individually up to this number.
MOST_MARKED = 10


class DesignStatus(Enum):
    """Status of a design; the value is the message."""

    EXACT = "exact: the law meets the target to 1e-9"
    REACHED = "reached: the law meets the target within 1 %"
    WITHIN_ERRORS = "within errors: the law meets the samples within 1 % and their stated errors"
    REFINED = "refined: the heights were adjusted until the law met the target within 1 %"
    APPROXIMATE = "approximate: the heights follow a density whose law has the target's slopes at large loads"
    ADJUSTED = "adjusted: the heights of a density were adjusted; the misfit is above 1 % and at most 10 %"
    MISSED = (
        "missed: the misfit is above 1 % (and the errors of the samples), or above 10 % for the heights of a "
        "density, or the base plane would touch"
    )

    @property
    def word(self) -> str:
        """The first words of the message, such as "reached"."""
        return self.value.partition(":")[0]


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
        Relative deviation of the law from the target [-]. For operating points, and for linear and bilinear
        laws over a load range, it is the largest deviation at any load. Otherwise it is the root mean square
        over the loads of the target, or the largest deviation of the fitted slopes of straight branches if
        this is larger. `misfit_meaning` states which definition applies.
    status : DesignStatus
    parameters : mapping
        Quantities found by the inversion: ``scale`` [mm], ``weight``, ``crossover_height`` [mm],
        ``counts``, ``levels`` [mm], ...
    sites : ndarray of int, (n,)
        Site of each asperity in the template, read-only.
    target, template, limits
        The arguments of the design.
    fits : tuple of (Branch, BranchFit)
        Straight branches of the target, each with the straight line fitted to the law.
    tools : RadiusRange, PowerRange, tuple of Tool or of float, or None
        Allowed tools of each asperity, or radii of tools [mm]; None for one common radius and cap.
    density : ExponentialDensity or None
        The density of heights whose law was sought, over the height above `limits.foot`.
    notes : tuple of Note
        Limitations of the design and of its model that matter for manufacturing.
    pinned : mapping of int to float or None
        Prescribed height above the base plane [mm] of each pinned site, None for an empty site.

    Notes
    -----
    Designs are equal if all their attributes are equal. Arrays must be bitwise equal. A design is equal to
    ``mf.load(folder)`` after it was saved to the folder.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> mf.design(mf.LinearLaw(6.87), template)
    Design: Linear friction law of slope 6.87
      status      approximate: the heights follow a density whose law has the target's slopes at large loads
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
    density: ExponentialDensity | None = None
    notes: tuple[Note, ...] = late(())
    tools: RadiusRange | PowerRange | tuple[float | Tool, ...] | None = None
    pinned: Pinned = field(default_factory=dict)

    def __post_init__(self) -> None:
        surface, template, known = self.surface, self.template, range(self.template.count)
        different = len(set(self.sites.tolist())) == surface.count == len(self.sites)
        words = f"sites must hold {surface.count} different sites of the template, from 0 to {known[-1]}"
        refuse_if(not different or not {*self.sites.tolist()} <= {*known}, words)
        moved = not np.array_equal(surface.position, template.position[self.sites])
        refuse_if(moved, "surface.position must be that of the template at the sites")
        refuse_if(not self.misfit >= 0.0, f"misfit = {self.misfit:g} must be at least 0")
        other = (self.law.material, self.law.friction) != (surface.material, surface.friction)
        refuse_if(other, "law.material and law.friction must be those of the surface")
        bare = self.density is not None and not self.fits
        refuse_if(bare, "fits must hold the branches of the height density")
        found = dict(zip(self.sites.tolist(), surface.height.tolist(), strict=True))
        for site, height in self.pinned.items():
            wanted = "empty" if height is None else f"{height:g} mm high"
            refuse_if(found.get(site) != height, f"site {site} must be {wanted}, as pinned states")
        for value in (self.sites, *self.parameters.values()):
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        for name in ("parameters", "pinned"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))

    def __reduce__(self) -> Any:
        # a mapping proxy cannot be pickled; the constructor makes a new one
        members = {member.name: getattr(self, member.name) for member in fields(self)}
        plain = {"parameters": dict(self.parameters), "pinned": dict(self.pinned)}
        return partial(Design, **members | plain), ()

    def __repr__(self) -> str:
        lines = [f"  {name:<11} {words}" for name, words in self._facts().items()]
        return "\n".join([f"Design: {self.target.title}", *lines])

    def _facts(self) -> dict[str, str]:
        """Return the quantities for the printed summary."""
        surface, law = self.surface, self.law
        empty = sum(height is None for height in self.pinned.values())
        pinned = {"pinned": f"{len(self.pinned) - empty} with a given height, {empty} empty"}
        return {
            "status": self.verdict,
            "misfit": f"{misfit_text(self.misfit)}, {self.misfit_meaning}",
            "asperities": f"{surface.count:,} on {self.template.count:,} sites{empty_sites_words(self)}",
            "heights": span(surface.height, "mm"),
            **(pinned if self.pinned else {}),
            "radius": span(surface.radius, "mm"),
            "model": repr(law.model),
            "law": f"{len(law.load):,} loads {span(law.load, 'N')}, area {span(law.area, 'mm^2')}",
            "parameters": ", ".join(self.parameters),
            "notes": printed_count(self, law),
        }

    @property
    def target_law(self) -> TargetLaw:
        """Reference law of `misfit`: the law of the height density if there is one, otherwise the target."""
        law = self.target.curve()
        if law is not None:
            return law
        assert self.density is not None
        branches = tuple(branch for branch, _ in self.fits)
        radius = float(self.surface.cap.summit_radius(self.surface.radius)[0])
        return law_of(self.density, branches, self.surface.count, radius)

    @cached_property
    def target_area(self) -> FloatArray:
        """A0 under the model at the loads of `target_law`, (k,) [mm^2]; computed when first read."""
        return self.law.model.curve(self.surface, self.target_law.load).checked().area

    @property
    def largest_misfit(self) -> float:
        """Largest misfit [-] that counts as reached: 1 % plus the target's errors, or 10 % for a density."""
        return MISSED if self.density is not None else REACHED + self.target_law.noise

    @property
    def verdict(self) -> str:
        """Status in one line, or what outweighs it: another model misses the target, or the base touches."""
        first = self.notes[0] if self.notes else None
        if first is not None and first.quantity == DOUBT:
            return first.text
        if self.status is DesignStatus.MISSED and self.misfit <= self.largest_misfit:
            return "missed: the base plane would touch at loads of the target"
        return self.status.value

    @property
    def misfit_meaning(self) -> str:
        """Definition of `misfit` for this design, in words."""
        if self.target_law.pointwise:
            return "largest difference from the target"
        slopes = [abs(fit.slope / branch.slope - 1.0) for branch, fit in self.fits]
        if slopes and self.misfit <= max(slopes):
            return "difference of a fitted slope from the target's"
        return (
            f"rms difference from {'the target' if self.density is None else 'the law of the height density'}"
        )

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the achieved law and the target in rescaled units, and return the axes.

        For a design with a height density, the law of the density and straight lines with the target slopes
        are drawn instead of the target. The load ranges of straight branches are shaded.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.

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


def few(law: TargetLaw) -> bool:
    """Return whether a plot marks each load of a target."""
    return len(law.load) <= MOST_MARKED


def draw_laws(design: Design, ax: Axes, label: str = "achieved") -> None:
    """Draw the achieved law with its label, and the target or the law of its height density."""
    design.law.plot(ax, label=label)
    law = design.target_law
    if design.density is None:
        draw_target(design, ax, law.load, law.law(design.target_area) if law.is_open else law.middle)
    else:
        ax.plot(law.load, law.middle, "k:", lw=1.0, label="law of the height density")
    for i, (branch, fit) in enumerate(design.fits if design.density is not None else ()):
        load, words = np.array(branch.load_range), "target slope"
        start = fit.intercept + (fit.slope - branch.slope) * load.mean()
        if branch.intercept is not None:
            load, words, start = load * [0.0, 1.0], "target slope, asymptote", branch.intercept
        ax.plot(load, start + branch.slope * load, color=TARGET, lw=1.4, label=words if i == 0 else None)
    for branch, _ in design.fits:
        ax.axvspan(*branch.load_range, color=TARGET, alpha=0.06, lw=0)
    ax.legend(frameon=False, loc="upper left")


def draw_target(design: Design, ax: Axes, load: FloatArray, friction: FloatArray) -> None:
    """Draw a target with a mark at each load if it has few loads, otherwise with a line for each branch.

    `load` and `friction`, (k,), are the values of `design.target_law` in any units.
    """
    law = design.target_law
    if law.is_band:
        lowest, highest = (friction / law.middle * end for end in (law.lower, law.upper))
        style: dict[str, Any] = {"ls": "--", "marker": "." if few(law) else "", "color": TARGET}
        ax.plot(load, lowest, **style, label="target: between these")
        ax.plot(load, highest, **style)
        ax.fill_between(load, lowest, highest, color=TARGET, alpha=0.06, lw=0)
        return
    if few(law):
        ax.plot(load, friction, "o", ms=7, color=TARGET, label="target", zorder=3)
        return
    ends = [branch.load_range for branch, _ in design.fits] or [(law.load[0], law.load[-1])]
    for i, (low, high) in enumerate(ends):
        on = (law.load >= low) & (law.load <= high)
        label = "target" if i == 0 else None
        ax.plot(load[on], friction[on], "--", lw=1.8, color=TARGET, label=label, zorder=3)


def empty_sites_words(design: Design) -> str:
    """Return the reason why some sites are empty although the law meets the target.

    Without adhesion, the area of one contact is a concave function of its load, so an additional contact
    increases A0 at a fixed load.
    """
    filled = design.surface.count + sum(height is None for height in design.pinned.values())
    unknown = design.status is DesignStatus.MISSED or contact_of(design.law.model).adhesive
    if filled == design.template.count or unknown:
        return ""
    return "; one more asperity in contact would exceed the target"


def misfit_text(misfit: float, digits: int = 2) -> str:
    """Return a misfit in percent, or a statement that it is within the tolerance of exact designs.

    The text has enough digits to show on which side of a limit the misfit lies: 1.003 % is not "1 %".
    """
    if misfit <= EXACT:
        return "below 1e-9"
    for limit in (REACHED, MISSED):
        while digits < MOST_DIGITS and (float(f"{misfit:.{digits}g}") > limit) != (misfit > limit):
            digits += 1
    return percent(misfit, f".{digits}g")
