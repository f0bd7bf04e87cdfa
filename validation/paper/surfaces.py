"""The five surfaces of the paper's Figs. 3 to 5, designed from their targets."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from validation.published import paper, table

# Radius of all asperities [mm].
RADIUS = paper()["sample"]["radius_um"] / 1e3

# Loads P/E* [mm²], from the lightest measured ones to loads beyond full contact of all surfaces.
LOADS = 0.7 * np.arange(1, 21) / 20


def template(figure: str) -> mf.Surface:
    """Return the paper's lattice with the material pair of one figure, such as "fig4_blue"."""
    printed = paper()
    sample, batch = printed["sample"], printed["batch"]["2" if figure == "fig5_red" else "1"]
    strength = printed["shear_strength_MPa"][figure][0]
    width, thickness = sample["block_width_mm"], sample["block_thickness_mm"]
    return mf.Surface.square_lattice(
        0.0,
        tuple(sample["lattice_shape"]),
        sample["lattice_pitch_mm"],
        radius=RADIUS,
        material=mf.Material(batch["composite_modulus_MPa"], 0.5),
        friction=mf.Friction(strength, batch["area_ratio"]),
        block=mf.Block(width, width, thickness),
    )


def fig3() -> mf.Design:
    """Design the surface of Fig. 3 for three operating points."""
    printed = paper()["fig3"]
    target = mf.OperatingPoints(printed["load_mm2"], printed["friction_mm2"])
    return mf.design(target, template("fig3"), limits=mf.Limits(printed["max_height_um"] / 1e3))


def fig4(colour: str) -> mf.Design:
    """Design a surface of Fig. 4 for a linear law, "blue" or "red"."""
    law = paper()["fig4"][colour]
    height, offset = law["max_height_um"] / 1e3, law["offset_um"] / 1e3
    limits = mf.Limits(height, offset=offset, height_step=paper()["fig4"]["level_step_um"] / 1e3)
    return mf.design(mf.LinearLaw(law["target_slope"]), template(f"fig4_{colour}"), limits=limits)


def fig5(colour: str) -> mf.Design:
    """Design a surface of Fig. 5 for a bilinear law, "blue" or "red"."""
    printed = paper()["fig5"]
    target = mf.BilinearLaw(printed["slopes"], printed[colour]["crossover_load_mm2"])
    limits = mf.Limits(printed["max_height_um"] / 1e3, offset=printed["offset_um"] / 1e3)
    return mf.design(target, template(f"fig5_{colour}"), limits=limits)


@cache
def designs() -> dict[str, mf.Design]:
    """Return the five designs under independent asperities."""
    linear = {f"Fig. 4 {colour}": fig4(colour) for colour in ("blue", "red")}
    return {"Fig. 3": fig3(), **linear, **{f"Fig. 5 {colour}": fig5(colour) for colour in ("blue", "red")}}


@cache
def surfaces() -> dict[str, mf.Surface]:
    """Return the five surfaces; those of Fig. 5 with the heights of Table S2.

    Table S2 numbers the asperities from 1 to 64 and gives no site. Here Table S2 is numbered row by row, an
    assumption of this check, on which independent asperities do not depend.
    """
    found = {name: design.surface for name, design in designs().items()}
    for colour, height in table("table_s2").items():
        if colour in ("blue", "red"):
            found[f"Fig. 5 {colour}"] = template(f"fig5_{colour}").replaced(height=height / 1e3)
    return found


def friction_of_slope(surface: mf.Surface) -> float:
    """Return the friction coefficient of a slope of 1, σB/E*."""
    friction = surface.friction
    assert friction is not None
    return friction.shear_strength * friction.area_ratio / surface.material.composite_modulus


def words(name: str) -> str:
    """Return the name of a surface, such as "Fig. 4 blue", in words: "Fig. 4, blue surface"."""
    figure, _, colour = name.partition(" ")[2].partition(" ")
    return f"Fig. {figure}, {colour} surface" if colour else name
