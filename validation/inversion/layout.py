"""Where each height stands: interaction and misalignment before and after an arrangement.

The paper leaves the places open. Its five surfaces are arranged under the half-space so that the law
follows that of independent asperities, and two of them also so that a tilt of .1 degrees matters least.
That of Fig. 3 has six asperities fewer than places: it is arranged on its own places, and on all of them.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from validation.check import Check, Claim, below
from validation.paper.interaction_error import surfaces
from validation.paper.surfaces import fig3

# The tests of this claim carry the mark "slow".
SLOW = True

# Loads P/E* [mm²] from the lightest measured ones to full contact of the surfaces.
LOADS = 0.6 * np.arange(1, 21) / 20

# Between the loads that the arrangement knows.
OTHER_LOADS = np.linspace(0.03, 0.6, 58)

MODEL = mf.Interacting()
FOLLOW, TILT = mf.FollowLaw(LOADS), mf.InsensitiveToTilt(LOADS[2::3])
TILTED = ("Fig. 4 red", "Fig. 5 red")

# Arrangements of the surface with empty places, of which the best counts.
SEEDS = 5


@cache
def arranged(name: str, tilt: bool) -> mf.Arrangement:
    """Return a surface arranged for its law, or for its law and for tilt."""
    return mf.arrange(surfaces()[name], mf.Together([FOLLOW, TILT]) if tilt else FOLLOW, MODEL)


@cache
def with_freedom(free: bool) -> list[mf.Arrangement]:
    """Return the surface of Fig. 3 arranged from several seeds, on its own places or on all."""
    design = fig3()
    places = design.template.position if free else None
    return [mf.arrange(design.surface, FOLLOW, MODEL, rng, places=places) for rng in range(SEEDS)]


def rms(objective: mf.FollowLaw | mf.InsensitiveToTilt, surface: mf.Surface) -> float:
    """Root mean square of the change."""
    return float(np.linalg.norm(objective.residual(surface, MODEL)))


def claim() -> Claim:
    """Measure the changes of A0 as placed and as arranged."""
    checks = []
    between = mf.FollowLaw(OTHER_LOADS)
    for name, surface in surfaces().items():
        before, after = rms(between, surface), rms(between, arranged(name, False).surface)
        checks.append(_told(f"{name}: rms by interaction, as placed", before))
        share = 0.2 if "5" in name else 0.8  # Figs. 3 and 4: on levels, whose entries shift as a whole
        checks.append(below(f"{name}: the same, arranged", after, share * before, "as placed"))
    before = rms(between, surfaces()["Fig. 3"])
    for free, words in ((False, "its 58 places"), (True, "all 64 places")):
        found = [rms(between, result.surface) for result in with_freedom(free)]
        what = f"Fig. 3 on {words}, {SEEDS} seeds"
        checks.append(_told(f"{what}: median rms", float(np.median(found))))
        checks.append(below(f"{what}: least rms", min(found), 0.5 * before, "as placed"))
    for name in TILTED:
        surface, result = surfaces()[name], arranged(name, True).surface
        checks.append(_told(f"{name}: rms by a tilt of .1°, as placed", rms(TILT, surface)))
        checks += [
            below(f"{name}: the same, arranged", rms(TILT, result), 0.75 * rms(TILT, surface), "as placed"),
            below(f"{name}: rms by interaction, arranged for both", rms(between, result),
                  0.5 * rms(between, surface), "as placed"),
        ]  # fmt: skip
    return Claim("Places against interaction and tilt", checks, {"interaction": _laws, "tilt": _tilts})


def _told(name: str, value: float) -> Check:
    """Report a number that nobody has printed."""
    return Check(name, value, "measured", bool(np.isfinite(value)), "")


def _laws():
    figure = new_figure(8.0, 3.4)
    ax = figure.add_subplot()
    for i, (name, surface) in enumerate(surfaces().items()):
        alone = mf.Independent().curve(surface, OTHER_LOADS).area
        for part, style in ((surface, "--"), (arranged(name, False).surface, "-")):
            change = 100.0 * (MODEL.curve(part, OTHER_LOADS).area / alone - 1.0)
            ax.plot(OTHER_LOADS, change, style, color=f"C{i}", label=name if style == "-" else None)
    ax.set_xlabel("rescaled load  P/E* [mm²]")
    ax.set_ylabel("change of A0 by interaction [%]")
    ax.set_title("as placed (dashed) and arranged", fontsize=9)
    ax.legend(frameon=False)
    return figure


def _tilts():
    figure = new_figure(8.0, 3.4)
    ax = figure.add_subplot()
    direction = 2.0 * np.pi * np.arange(25) / 24
    slope = np.tan(TILT.angle) * np.stack([np.cos(direction), np.sin(direction)], axis=1)
    for i, name in enumerate(TILTED):
        for part, style in ((surfaces()[name], "--"), (arranged(name, True).surface, "-")):
            level = MODEL.curve(part, LOADS).area
            heights = part.height + slope @ part.position.T
            change = MODEL.curves(part, heights, LOADS)[2] / level - 1.0
            ax.plot(np.degrees(direction), 100.0 * change[:, 5], style, color=f"C{i}",
                    label=name if style == "-" else None)  # fmt: skip
    ax.set_xlabel("direction of a tilt of .1° [°]")
    ax.set_ylabel(f"change of A0 at {LOADS[5]:.2g} mm² [%]")
    ax.set_title("as placed (dashed) and arranged for both", fontsize=9)
    ax.legend(frameon=False)
    return figure
