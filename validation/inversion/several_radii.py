"""Laws that one radius for all asperities cannot have, with a radius for each asperity."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from metafem.inversion.bounds import Bounds
from metafem.inversion.radii import Radii
from validation.check import LINE_REQUIRED, REQUIRED, Check, Claim, below, near
from validation.paper.surfaces import template
from validation.published import PAPER
from validation.scenes.models import MODELS

# Two tool radii, or any radius between them [mm]; loads and heights of the power laws.
TOOLS = [0.2, 0.8]
CHOICES = {"two tools": TOOLS, "any radius between": mf.RadiusRange(0.2, 0.8)}
RANGE, LIMITS = (0.1, 0.4), mf.Limits(0.27, offset=0.05)
BOUNDS = Bounds(mf.Hertz(), Radii.given(TOOLS), 64, RANGE[1])


# Below 2/3 and above 1.51, the range of one radius within 1 %.
EXPONENTS = (0.645, 1.55)

# Halvings of the interval of the largest exponent, to a hundredth of it.
HALVINGS = 6

# Longer than a few seconds: laws that cannot be reached use all restarts.
SLOW = True


@cache
def designed(exponent: float, choice: str, model: str) -> mf.Design:
    """Return the surface of a power law."""
    target = mf.PowerLaw(exponent, RANGE)
    return mf.design(target, template("fig4_red"), MODELS[model], LIMITS, radii=CHOICES[choice])


def claim() -> Claim:
    """Design power laws and friction coefficients beyond those of one radius."""
    checks = [
        below(
            f"exponent {e:g}, {choice}, {model}: misfit", designed(e, choice, model).misfit, 1.5e-3, REQUIRED
        )
        for e in EXPONENTS
        for choice in CHOICES
        for model in MODELS
    ]
    return Claim(
        "A radius for each asperity",
        [*checks, _largest(), *_least(), *_coefficients()],
        {"exponents": _exponents, "surface": _surface},
    )


def _largest() -> Check:
    bound = BOUNDS.largest_exponent(RANGE)
    reached, beyond = 1.51, bound
    for _ in range(HALVINGS):
        middle = 0.5 * (reached + beyond)
        met = designed(middle, "two tools", "independent").misfit <= 0.01
        reached, beyond = (middle, beyond) if met else (reached, middle)
    return Check(
        "largest exponent within 1 % with two tools (one radius: 1.51)",
        reached,
        f"above 1.51, at most {bound:.3g}",
        bool(1.51 < reached <= bound),
        "closed form: 2/3 + ln(N^(1/3) (R2/R1)^(2/3))/ln(P2/P1), from one small to N large Hertz contacts",
    )


def _least() -> list[Check]:
    """Exponents of random contacts of two radii are above the least exponent, and approach it."""
    least = BOUNDS.least_exponent
    rng = np.random.default_rng(0)
    R = rng.choice(TOOLS, (200_000, 12))
    a = (
        R
        * rng.uniform(0.05, 1.0, (200_000, 1))
        * np.where(TOOLS[0] == R, rng.uniform(0.5, 2.0, (200_000, 1)), 1.0)
    )
    found = 2.0 / 3.0 * R.sum(axis=1) * (a**3 / R).sum(axis=1) / ((a**2).sum(axis=1) * a.sum(axis=1))
    source = "closed form for Hertz contacts of two radii, metafem/inversion/bounds.py"
    return [
        below(
            "least exponent minus the smallest of 200,000 random surfaces",
            least - float(found.min()),
            1e-12,
            source,
        ),
        near("smallest exponent of 200,000 random surfaces", float(found.min()), least, 1e-3, source),
    ]


def _coefficients() -> list[Check]:
    """Friction coefficients range from the least of the smaller tool to the largest of the larger one."""
    pair, limits = template("fig4_red"), mf.Limits(0.12, offset=0.1, height_sd=0.003)
    single = [mf.achievable_friction_coefficients(pair, limits, [radius]) for radius in (0.2, 1.6)]
    both = mf.achievable_friction_coefficients(pair, limits, [0.2, 1.6])
    target = mf.LinearLaw.from_friction_coefficient(
        0.5 * (single[0][1] + single[1][0]), pair.material, pair.friction
    )
    found = mf.design(target, pair, limits=limits, radii=[0.2, 1.6])
    return [
        near(
            "least friction coefficient with both tools",
            both[0],
            single[0][0],
            1e-12,
            f"{PAPER}, lower bound 3π/4 √(R/h_m) σB/E* with the smaller radius",
        ),
        near(
            "largest with both",
            both[1],
            single[1][1],
            1e-12,
            f"{PAPER}, eq. S3 with the larger radius and λ of ten height errors",
        ),
        below("coefficient between the ranges of the two tools: misfit", found.misfit, 0.1, LINE_REQUIRED),
        near(
            "radii in use",
            float(len(np.unique(found.surface.radius))),
            2.0,
            0.0,
            "neither radius alone has this coefficient, by the bounds above",
        ),
    ]


def _exponents():
    figure = new_figure(9.6, 3.6)
    bounds = {
        0.645: (2.0 / 3.0, "least exponent of one radius: 2/3"),
        1.55: (1.51, "largest exponent of one radius: 1.51"),
    }
    for ax, exponent in zip(figure.subplots(1, 2), EXPONENTS, strict=True):
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
        ax.legend(frameon=False, fontsize=8)
    return figure


def _surface():
    figure = new_figure(8.0, 3.0)
    ax = figure.add_subplot()
    for exponent, marker in zip(EXPONENTS, "ox", strict=True):
        for choice in CHOICES:
            surface = designed(exponent, choice, "independent").surface
            depth = 1e3 * (surface.height.max() - surface.height)
            ax.semilogy(depth, surface.radius, marker, ms=4, label=f"{exponent:g}, {choice}")
    ax.set_xlabel("depth of the summit below the tallest [µm]")
    ax.set_ylabel("radius [mm]")
    ax.legend(frameon=False, fontsize=8)
    return figure
