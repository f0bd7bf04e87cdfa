"""Laws that one radius for all asperities cannot have, with a radius for each asperity."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.reference import hertz, slope, smallest_slope
from validation.check import LINE_REQUIRED, REQUIRED, Claim, Picture, Row, above, below, near
from validation.figures import panels
from validation.inversion.later_targets import area_at, largest_exponent
from validation.paper.surfaces import friction_of_slope, template
from validation.scenes.models import MODELS
from validation.sources import closed_form, self_consistency

# Two tool radii, or any radius between them [mm]; loads and heights of the power laws.
TOOLS = [0.2, 0.8]
CHOICES = {"two tools": TOOLS, "any radius between": mf.RadiusRange(0.2, 0.8)}
RANGE, LIMITS = (0.1, 0.4), mf.Limits(0.27, offset=0.05)


# Below 2/3 and above what one radius reaches within 1 %.
EXPONENTS = (0.645, 1.55)


# Longer than a few seconds: laws that cannot be reached use all restarts.
SLOW = True


@cache
def designed(exponent: float, choice: str, model: str) -> mf.Design:
    """Return the surface of a power law."""
    target = mf.PowerLaw(exponent, RANGE)
    return mf.design(target, template("fig4_red"), MODELS[model], LIMITS, tools=CHOICES[choice])


def claim() -> Claim:
    """Caps of one radius cannot have a friction law less steep than the power 2/3 of the load, and none much
    steeper than the power 1.4. With a radius for each cap, from two tools or from a range, laws beyond both
    are designed under each model, and friction coefficients between the ranges of the single tools.
    """
    checks: list[Row] = [
        below(
            f"exponent {e:g}, {choice}, {model}: misfit", designed(e, choice, model).misfit, 1.5e-3, REQUIRED
        )
        for e in EXPONENTS
        for choice in CHOICES
        for model in MODELS
    ]
    return Claim(
        "A radius for each asperity",
        [*checks, *_largest(), *_coefficients()],
        {"laws with a small and a large exponent": Picture(_exponents)},
    )


def _largest() -> list[Row]:
    reached = largest_exponent(tuple(TOOLS))
    first, last = area_at(RANGE[0], min(TOOLS)), 64 * area_at(RANGE[1] / 64, max(TOOLS))
    bound = float(np.log(last / first) / np.log(RANGE[1] / RANGE[0]))
    one = self_consistency(largest_exponent, "the same search with one radius")
    ends = closed_form(hertz, "one small contact at the first load, 64 large ones at the last")
    return [
        above("largest exponent within 1 % with two tools", reached, largest_exponent(), one),
        below("largest exponent with two tools against its bound", reached, bound, ends),
    ]


def _coefficients() -> list[Row]:
    """Friction coefficients range from the least of the smaller tool to the largest of the larger one."""
    pair, limits = template("fig4_red"), mf.Limits(0.12, offset=0.1, height_sd=0.003)
    stress = friction_of_slope(pair)
    single = [mf.achievable_friction_coefficients(pair, limits, [radius]) for radius in (0.2, 1.6)]
    both = mf.achievable_friction_coefficients(pair, limits, [0.2, 1.6])
    target = mf.LinearLaw.from_friction_coefficient(
        0.5 * (single[0][1] + single[1][0]), pair.material, pair.friction
    )
    found = mf.design(target, pair, limits=limits, tools=[0.2, 1.6])
    return [
        near(
            "least friction coefficient with both tools",
            both[0],
            stress * smallest_slope(0.2, limits.max_height),
            1e-12,
            closed_form(smallest_slope, "μ = σB/E* · 3π/4 √(R/h_m) with the smaller radius"),
        ),
        near(
            "largest with both",
            both[1],
            stress * slope(10.0 * limits.height_sd, 1.6, limits.max_height),
            1e-12,
            closed_form(slope, "eq. S3 with the larger radius and λ of ten height errors"),
        ),
        below("coefficient between the ranges of the two tools: misfit", found.misfit, 0.1, LINE_REQUIRED),
    ]


@panels(9.6, 3.6, columns=2)
def _exponents(*axes):
    """Friction divided by the power law of one radius that is nearest to the target, which is the grey line.
    The surfaces with caps of two radii must follow the dashed target, which is steeper or less steep.
    """
    largest = largest_exponent()
    bounds = {
        0.645: (2.0 / 3.0, "least exponent of one radius: 2/3"),
        1.55: (largest, f"largest exponent of one radius: {largest:.3g}"),
    }
    for ax, exponent in zip(axes, EXPONENTS, strict=True):
        known, label = bounds[exponent]
        for model, solver in MODELS.items():
            result = designed(exponent, "two tools", model)
            law = result.target_law
            area = solver.curve(result.surface, law.load).area / (law.load / RANGE[0]) ** known
            ax.semilogx(law.load, area / area[0], label=model)
        ax.semilogx(law.load, (law.load / RANGE[0]) ** (exponent - known), "k--", lw=0.8, label="target")
        ax.axhline(1.0, color="grey", lw=0.8, label=label)
        ax.set_title(f"exponent {exponent:g}", fontsize=10)
        ax.set_xlabel("rescaled load  P/E* [mm²]")
        ax.set_ylabel(f"A0/P^{known:.3g}, relative to its first value")
