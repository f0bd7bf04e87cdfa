"""Heights on the steps of a machine, for every kind of law."""

import numpy as np

import metafem as mf

STEP = 0.006

TARGETS = {
    "points": mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]),
    "sampled": mf.SampledLaw([0.1, 0.2, 0.3, 0.4], [0.9, 1.6, 2.3, 3.0]),
    "power": mf.PowerLaw(1.2, (0.1, 0.4)),
    "multilinear": mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26)),
}


def test_moves_win_over_rounding(template):
    free = mf.design(TARGETS["power"], template, limits=mf.Limits(0.27))
    stepped = mf.design(TARGETS["power"], template, limits=mf.Limits(0.27, height_step=STEP))
    rounded = free.surface.replaced(height=STEP * np.rint(free.surface.height / STEP))
    load = np.geomspace(0.1, 0.4, 30)
    ratio = mf.Independent().curve(rounded, load).area / load**1.2
    assert stepped.misfit < 0.5 * float(ratio.std() / ratio.mean())


def test_bilinear_law_stands_on_steps(template):
    limits = mf.Limits(0.12, offset=0.05, height_step=0.001)
    result = mf.design(mf.BilinearLaw((7.15, 12.52), 0.038), template, limits=limits)
    steps = (result.surface.height - limits.foot) / 0.001 - 0.5
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)
    assert result.misfit < 0.1
