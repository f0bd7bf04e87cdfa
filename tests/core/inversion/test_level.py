"""Targets at which double precision ends, or which no number of asperities meets."""

import math

import metafem as mf
from metafem.inversion.strategies.level import Level, Step


def test_no_number_of_asperities_meets_a_point_whose_load_the_earlier_ones_exceed(template):
    hertz = mf.Hertz().for_material(template.material)
    earlier = Level(height=0.1, number=10, radius=0.526, other=0.526, depth=0.0, adjustment=0.0)
    # ten contacts of Hertz at 0.05 mm carry 0.108 mm^2 with 0.83 mm^2 of area
    assert Step(hertz, (earlier,), height=0.05, load=0.05, friction=1.0).needed(0.526) == math.inf
    assert math.isfinite(Step(hertz, (earlier,), height=0.05, load=0.2, friction=1.0).needed(0.526))
