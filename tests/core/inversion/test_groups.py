"""Groups of equal asperities that meet operating points."""

import math
from itertools import islice

import numpy as np

import metafem as mf
from metafem.inversion.strategies.groups import GroupStep
from metafem.inversion.strategies.level import asperities
from metafem.models import Independent

RADIUS, MATERIAL = 0.526, mf.Material(1.36)
LAWS = [mf.Hertz(), mf.Elastic(mf.Sphere()), mf.JKR(9e-6).for_material(MATERIAL)]


def law_of(contact, height, load):
    """Return A0 of independent asperities at loads."""
    return Independent(contact=contact).curve_of(height, np.full(len(height), RADIUS), np.array(load)).area


def steps(contact, height, loads, most):
    """Return all groups that meet the points of a law one after the other, at most `most` for each point."""
    paths = [()]
    for load, area in zip(loads, law_of(contact, height, loads), strict=True):
        longer = []
        for done in paths:
            top = done[-1].height - done[-1].depth if done else 0.3
            step = GroupStep(contact, done, top, load, float(area), deepest=math.inf)
            left = len(height) - sum(level.count for level in done)
            longer += [(*done, level) for level in islice(step.levels((RADIUS,), left), most)]
        paths = longer
    return paths


def test_the_groups_of_a_surface_are_found():
    for tops, others, gap in [(3, 2, 0.004), (2, 6, 0.02)]:
        for contact in LAWS:
            height = np.repeat([0.3, 0.3 - gap], [tops, others])
            found = [path[0] for path in steps(contact, height, [0.03], 64)]
            same = [level for level in found if (level.number, level.others) == (tops, others)]
            assert any(abs(level.depth - level.adjustment - gap) < 1e-9 for level in same)


def test_all_groups_have_the_law_of_the_points():
    """The law is that of the first state on loading, recomputed from the heights."""
    for contact in LAWS:
        height = 0.3 - np.array([0.0, 0.001, 0.002, 0.004, 0.006, 0.011, 0.012, 0.018])
        loads = [0.004, 0.03]
        paths = steps(contact, height, loads, 4)
        assert paths
        for path in paths:
            np.testing.assert_allclose(
                law_of(contact, asperities(path)[0], loads), law_of(contact, height, loads), rtol=1e-9
            )
