"""Effect of the arrangement, the distance of the asperities and the size of the base on A0 by interaction.

A later paper, Zeka et al. (2026), doi:10.48550/arXiv.2604.08195, studies these effects by finite elements;
only its abstract was available.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.drawing import ACHIEVED
from validation.check import Claim, Picture, Row, near, reported
from validation.figures import panels
from validation.paper.surfaces import fig4
from validation.sources import known_input, second_method

# Blocks of finite elements.
SLOW = True

# Loads P/E* [mm²] from a tenth of the load of full contact on, at which A0 is compared.
LOADS = np.linspace(0.05, 0.6, 12)

# Pitches [mm], thicknesses of a wide base [mm], widths of the paper's base with free sides [mm].
PITCHES, THICKNESSES, WIDTHS = (0.8, 1.0, 1.5, 2.0, 3.0), (1.0, 2.0, 7.2), (17.0, 20.0, 30.0)
WIDE, DEPTH, BLOCK = 40.0, 100.0, mf.fe.Block3D(cell=0.5, edge_cell=0.05)
ARRANGEMENTS = 100

DEEP = second_method(mf.HalfSpace, "the base without end, in this run")
WIDEST = second_method(mf.BondedLayer, "the layer without sides, in this run")
SAME = known_input("identity: a displacement that is equal for all asperities leaves A0(P) unchanged")

METHOD = "interaction of order 3 against independent asperities, rms of A0 at twelve loads"


def change(surface: mf.Surface, model: mf.Model) -> float:
    """Return the rms of the relative change of A0 by interaction."""
    alone = mf.Independent().curve(surface, LOADS).area
    return float(np.sqrt(np.mean((model.curve(surface, LOADS).area / alone - 1.0) ** 2)))


@cache
def arranged() -> FloatArray:
    """Return the changes on the half-space of random arrangements of the heights."""
    surface = fig4("red").surface
    return np.array(
        [change(surface.shuffled(rng=1 + seed), mf.Interacting()) for seed in range(ARRANGEMENTS)]
    )


@cache
def based(pitch: float, thickness: float) -> float:
    """Return the change on a wide base for a pitch and a thickness [mm], infinite for a half-space."""
    surface = fig4("red").surface
    moved = surface.replaced(position=surface.position * pitch / 1.5)
    if np.isinf(thickness):
        return change(moved, mf.Interacting())
    layer = mf.Interacting(substrate=mf.BondedLayer())
    return change(moved.replaced(block=mf.Block(WIDE, WIDE, thickness)), layer)


def claim() -> Claim:
    """Independent asperities have the same law wherever they stand. Elastic interaction through the base
    depends on their places, and here its effect is computed for the surface of Fig. 4, red: for random
    places, for heights in increasing order, for other distances, and for thinner and narrower bases. On the
    paper's block it is about 1 %; a base of 1 mm, or heights that increase from one end to the other, change
    the law several times as much.
    """
    return Claim(
        "Arrangement, distance of the asperities and size of the base",
        _rows(),
        {"change of the law by interaction": Picture(_changes)},
    )


def _rows() -> list[Row]:
    surface, random = fig4("red").surface, arranged()
    ordered = surface.replaced(height=np.sort(surface.height))
    of_width = {
        width: change(surface.replaced(block=mf.Block(width, width, 7.2)), mf.Interacting(substrate=BLOCK))
        for width in WIDTHS
    }
    deep, half = based(1.5, DEPTH), based(1.5, np.inf)
    layer, widest = based(1.5, 7.2), of_width[WIDTHS[-1]]
    return [
        near(f"base {DEPTH:g} mm thick: change of A0", deep, half, 0.05 * half, DEEP),
        near(f"block {WIDTHS[-1]:g} mm wide: change of A0", widest, layer, 0.05 * layer, WIDEST),
        reported("random arrangements: least change of A0", random.min(), METHOD),
        reported("random arrangements: median change of A0", float(np.median(random)), METHOD),
        reported("random arrangements: largest change of A0", random.max(), METHOD),
        reported("heights in increasing order: change of A0", change(ordered, mf.Interacting()), METHOD),
        *(reported(f"pitch {pitch:g} mm: change of A0", based(pitch, np.inf), METHOD) for pitch in PITCHES),
        *(
            reported(f"base {thickness:g} mm thick: change of A0", based(1.5, thickness), METHOD)
            for thickness in THICKNESSES
        ),
        *(
            reported(f"base {width:g} mm wide, free sides: change of A0", each, METHOD)
            for width, each in of_width.items()
        ),
    ]


@panels(8.0, 3.2, columns=2)
def _changes(left, right):
    """Change of the area of real contact by elastic interaction, for the surface of Fig. 4, red. Left, over
    the distance of neighbouring asperities, on a half-space and on wide bases of three thicknesses; a thin
    base changes the law of each contact alone, at any distance. Right, of 100 random arrangements at the
    paper's pitch.
    """
    for thickness in (*THICKNESSES, np.inf):
        label = "half-space" if np.isinf(thickness) else f"base {thickness:g} mm thick"
        left.plot(PITCHES, [100.0 * based(pitch, thickness) for pitch in PITCHES], "o-", ms=3, label=label)
    left.set_xlabel("distance of neighbouring asperities [mm]")
    left.set_ylabel("rms change of A0 [%]")
    left.set_ylim(0.0, 10.0)
    left.legend(frameon=False, fontsize=8, ncols=2)
    right.hist(100.0 * arranged(), 20, color=ACHIEVED)
    right.set_xlabel("rms change of A0 [%]")
    right.set_ylabel("random arrangements")
