"""Heights, radii and positions of caps on synthetic height maps, and their errors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MadeSurface
from validation.check import Claim, Picture, Row, below, near, rms
from validation.scenes.height_maps import Placement, Roughness, height_map
from validation.sources import known_input

# Two maps of 9 megapixels.
SLOW = True

PIXEL, RADIUS = 2e-3, 0.526
SHAPE, SITES = (3000, 3000), (4, 4)
ROUGHNESS = Roughness(1.2e-3, 8e-3)

# Errors of making: systematic ones, and the random ones of the paper.
OFFSET, SCALE, TILT, RANDOM = 3e-3, -0.02, 1e-3, 0.9e-3

TRUE = known_input("heights, radii and positions of the synthetic caps, of the paper's roughness")
DEVIATION = known_input("errors of the synthetic caps, whose standard errors the measurement states")


@dataclass(frozen=True, eq=False)
class _Part:
    """A part that was made with errors and measured."""

    design: mf.Surface
    true: mf.Surface
    made: MadeSurface
    heights: np.ndarray


@cache
def _part(seed: int) -> _Part:
    rng = np.random.default_rng(seed)
    height = rng.permutation(np.linspace(0.05, 0.27, SITES[0] * SITES[1]))
    design = mf.Surface.square_lattice(height, SITES, radius=RADIUS, material=mf.Material(1.36))
    true = design.replaced(height=_made(design, design, rng))
    place = Placement(0.01, (3.0011, 2.9993))
    heights = height_map(true, SHAPE, PIXEL, placement=place, roughness=ROUGHNESS, rng=rng)
    return _Part(design, true, mf.calibration.made_surface(heights, PIXEL, design), heights)


def _made(ordered: mf.Surface, design: mf.Surface, rng: np.random.Generator) -> FloatArray:
    """Return the heights that come out when a surface is ordered, with the errors of this workshop."""
    error = OFFSET + SCALE * (ordered.height - design.height.mean()) + TILT * ordered.position[:, 0]
    return ordered.height + error + RANDOM * rng.standard_normal(ordered.count)


def claim() -> Claim:
    """Two synthetic parts of 16 asperities with the paper's roughness are measured on height maps of 9
    megapixels. Heights are found to 0.1 µm, a ninth of the precision with which the paper's moulds were made.
    """
    parts = [_part(seed) for seed in (1, 2)]
    error, sd = (np.concatenate([each(part) for part in parts]) for each in (_errors, _sd))
    height, radius, x, y = error.T
    score = error / sd
    checks: list[Row] = [
        below("32 asperities: root mean square error of the heights [µm]", 1e3 * rms(height), 0.1, TRUE),
        below("of the radii [%]", 100.0 * rms(radius) / RADIUS, 0.5, TRUE),
        below("of the positions, both coordinates [µm]", 1e3 * rms(np.hypot(x, y)), 0.5, TRUE),
        below("largest error of a height [µm]", 1e3 * float(np.abs(height).max()), 0.3, TRUE),
        # of 128 normal values the root mean square has the standard error 1 / sqrt(256); the errors of the
        # positions after an alignment are smaller by the three parameters of 32 coordinates
        near("errors over their standard errors, root mean square", rms(score), 1.0, 0.2, DEVIATION),
    ]
    title = "Height maps: the made surface"
    return Claim(title, checks, {"a measured part": Picture(_figure)})


def _errors(part: _Part) -> FloatArray:
    """Return errors of height, radius and position (n, 4) [mm]."""
    made = part.made
    offset = made.surface.position - part.true.position
    height = made.surface.height - part.true.height
    return np.column_stack([height, made.surface.radius - part.true.radius, offset])


def _sd(part: _Part) -> FloatArray:
    made = part.made
    return np.column_stack([made.height_sd, made.radius_sd, made.position_sd, made.position_sd])


def _figure():
    """A synthetic part of 16 asperities, measured on a height map: errors of the heights at their sites; what
    is left of the map without plane and caps, which is roughness alone; the errors over the heights; and the
    friction laws as designed and as made.
    """
    from metafem.calibration.figures import made_figure
    from metafem.calibration.topography import HeightMap

    part = _part(1)
    heights = HeightMap(part.heights, (PIXEL, PIXEL))
    law = mf.friction_law(part.design)
    made = mf.friction_law(part.made.surface, load=law.load)
    return made_figure(part.made, heights, law, made)
