"""Target laws with open parameters, for one area curve and for many."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.search.target_law import TargetLaw

LOAD = np.geomspace(0.1, 0.4, 30)
LAWS = {
    "fixed": TargetLaw.fixed(LOAD, 7.0 * LOAD),
    "power": mf.PowerLaw(0.9, (0.1, 0.4)).curve(),
    "line": TargetLaw(LOAD, np.zeros(30), np.column_stack([LOAD, np.ones(30)]), np.ones(30)),
}


@pytest.mark.parametrize("name", LAWS)
def test_many_laws_are_those_of_each(name):
    law, random = LAWS[name], np.random.default_rng(0)
    area = 9.0 * LOAD**0.85 * (1.0 + 0.05 * random.standard_normal((20, 30)))
    # far from a line: the nearest one is not positive
    area[0] = 1e-3 + 1e3 * LOAD**8
    np.testing.assert_allclose(law.laws(area), [law.law(row) for row in area], rtol=1e-12)


def test_a_thinned_law_keeps_its_ends_and_weights():
    law = TargetLaw.fixed(LOAD, 7.0 * LOAD, np.arange(1.0, 31.0))
    thin = law.thinned(7)
    assert (len(thin.load), thin.load[0], thin.load[-1]) == (7, 0.1, 0.4)
    assert thin.weight.mean() == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_array_equal(thin.base, 7.0 * thin.load)
    assert law.thinned(30) is law
