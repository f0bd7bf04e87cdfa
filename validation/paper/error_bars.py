"""The error bars of Figs. 3 to 5: standard deviations over 10,000 draws of forces and parameters.

The paper prints the errors of the parameters and draws the bars; it prints none of their lengths. The bars of
the predicted laws are compared with as many plain draws, each of a surface of its own; those of measured
pairs with the propagation of small errors.
"""

from __future__ import annotations

import numpy as np

import metafem as mf
from validation.check import Claim, Picture, Row, near, reported
from validation.figures import panels
from validation.methods.small_errors import drawn_deviation, relative_error
from validation.paper.pictures import INKS
from validation.paper.surfaces import RADIUS, surfaces, words
from validation.published import paper
from validation.sources import second_method

# The tests of this claim carry the mark "slow".
SLOW = True

DRAWS = 10_000

# Loads of the checks and of the figure, as shares of the largest of the default grid of a law.
SHARES = np.array([0.1, 0.4, 1.0])
DRAWN = np.arange(1, 11) / 10

# Relative standard error of a deviation of plain draws, and the multiple that three of them exceed with 1e-2.
PLAIN = 1.0 / np.sqrt(2.0 * DRAWS)
WIDE = 3.0

# Second-order terms of the quotients, relative: a force of a tenth of the largest has an error of up to 7 %.
SECOND_ORDER = 0.01

BATCH_2 = "Fig. 5 red"

STUDY = f"mf.studies.uncertainty with {DRAWS} draws; the paper prints no bars"


def errors(name: str) -> dict[str, float]:
    """Return the standard deviations of the parameters of a figure, such as "Fig. 4 blue"."""
    printed = paper()
    batch = printed["batch"]["2" if name == BATCH_2 else "1"]
    key = name.lower().replace(". ", "").replace(" ", "_")
    return {
        "radius": printed["sample"]["radius_sd_um"] / 1e3,
        "composite_modulus": batch["composite_modulus_sd"],
        "load": printed["force_error"]["normal_N"],
        "shear_strength": printed["shear_strength_MPa"][key][1],
        "area_ratio": batch["area_ratio_sd"],
    }


def largest(name: str) -> float:
    """Return the largest load of a law [N]."""
    return float(mf.friction_law(surfaces()[name]).load[-1])


def measured(name: str, load: np.ndarray):
    """Return the bars of measured pairs that lie on the law."""
    surface, printed = surfaces()[name], paper()["force_error"]
    force = mf.friction_law(surface, load=load).friction_force
    sd = errors(name) | {"friction_force": printed["friction_N"] + printed["friction_relative"] * force}
    return mf.studies.uncertainty(surface, sd, draws=DRAWS, load=[load, force])


def claim() -> Claim:
    """The paper draws error bars that are standard deviations over 10,000 draws of forces and parameters, and
    prints the errors of the parameters but no bar. The bars are computed here from those errors: of the
    predicted A0 by draws of R, E* and P, compared with as many plain draws in numpy, and of measured pairs of
    forces, compared with the propagation of small errors.
    """
    rows: list[Row] = []
    plain = second_method(drawn_deviation, f"{DRAWS} plain draws of R, E* and P with the errors in the SM")
    for name in surfaces():
        load, sd, surface = largest(name) * SHARES, errors(name), surfaces()[name]
        found = mf.studies.uncertainty(surface, sd, draws=DRAWS, load=load)
        modulus = surface.material.composite_modulus, sd["composite_modulus"]
        ratio = found.area_sd.values / drawn_deviation(
            surface.height, (RADIUS, sd["radius"]), modulus, load, sd["load"], DRAWS
        )
        worst = float(ratio[np.abs(ratio - 1.0).argmax()])
        last = found.isel(rescaled_load=-1)
        rows += [
            near(f"{name}: deviation of A0 over that of plain draws, worst of three loads", worst, 1.0,
                 WIDE * PLAIN, plain),
            reported(f"{name}: error bar of A0 at the largest load, relative",
                     float(last.area_sd / last.area_mean), STUDY),
        ]  # fmt: skip
        rows += measured_checks(name)
    figures = {"Fig. 4 with error bars": Picture(figure)}
    return Claim("Figs. 3 to 5: error bars", rows, figures)


def measured_checks(name: str) -> list[Row]:
    """Compare the bars of a measured pair with the propagation of small relative errors."""
    load, sd, surface = largest(name) * SHARES[1:2], errors(name), surfaces()[name]
    found = measured(name, load).isel(rescaled_load=0)
    force, numbers = float(mf.friction_law(surface, load=load).friction_force[0]), paper()["force_error"]
    modulus, friction = surface.material.composite_modulus, surface.friction
    of_load = relative_error(sd["load"] / load[0], sd["composite_modulus"] / modulus)
    of_force = (numbers["friction_N"] + numbers["friction_relative"] * force) / force
    strength, ratio = sd["shear_strength"] / friction.shear_strength, sd["area_ratio"] / friction.area_ratio
    source = second_method(relative_error, "propagation of small errors, with the errors in the SM")
    of_friction = relative_error(of_force, strength, ratio)
    bars = (
        ("P/E*", found.rescaled_load_sd / found["rescaled_load"], of_load),
        ("F/(σB)", found.rescaled_friction_sd / found.nominal_rescaled_friction, of_friction),
    )
    return [
        near(f"{name}, measured pair: relative error of {what}", float(bar), expected,
             (WIDE * PLAIN + SECOND_ORDER) * expected, source)
        for what, bar, expected in bars
    ]  # fmt: skip


@panels(7.0, 4.0)
def figure(ax) -> None:
    """Predicted laws of Fig. 4 (lines), and points on them with the error bars of measured pairs: one
    standard deviation of the rescaled load P/E* and of the rescaled friction F/(σB), both in mm². The bars
    grow with the load, because the errors of E*, σ and B are relative; those of friction are the shorter
    ones.
    """
    for name in ("Fig. 4 blue", "Fig. 4 red"):
        mark = INKS[name]
        found = measured(name, largest(name) * DRAWN)
        law = mf.friction_law(surfaces()[name])
        ax.plot(law.rescaled_load, law.area, color=mark, lw=0.8)
        ax.errorbar(found["rescaled_load"], found.nominal_rescaled_friction, found.rescaled_friction_sd,
                    found.rescaled_load_sd, fmt="o", ms=3, lw=1.2, color=mark, label=words(name))  # fmt: skip
    ax.set(xlabel="rescaled load  P/E* [mm²]", ylabel="rescaled friction  F/(σB) [mm²]")
