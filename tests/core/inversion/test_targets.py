"""What every target states of itself."""

import numpy as np
import pytest

import metafem as mf

TARGETS = {
    "Friction law through 2 operating points": mf.OperatingPoints([0.1, 0.2], [0.8, 1.5]),
    "Friction law given by 2 samples": mf.SampledLaw([0.1, 0.2], [0.8, 1.5]),
    "Power law of exponent 1.2 from 0.1 to 0.2 mm²": mf.PowerLaw(1.2, (0.1, 0.2)),
    "Friction proportional to load: slope 7 from 0.1 to 0.2 mm²": mf.LinearLaw(7.0, (0.1, 0.2)),
    "Bilinear friction law of slopes 6 and 9 through the origin from 0.1 to 0.2 mm²": mf.BilinearLaw(
        (6.0, 9.0), 0.15, (0.1, 0.2)
    ),
    "Friction law of slopes 7 and 9": mf.MultilinearLaw([7.0, 9.0], [0.15], (0.1, 0.2)),
}


@pytest.mark.parametrize("title", TARGETS)
def test_a_target_states_its_law_up_to_its_last_load(title):
    target = TARGETS[title]
    assert target.title == title
    assert target.last_load == 0.2
    law = target.curve()
    assert law.load[[0, -1]].tolist() == [0.1, 0.2]
    assert law.misfit(law.law(np.linspace(0.8, 1.5, len(law.load)))) == pytest.approx(0.0, abs=1e-12)


def test_branches_share_an_intercept_where_they_meet():
    joined, apart = (mf.MultilinearLaw([7.0, 9.0], [c], (0.1, 0.2)).curve() for c in (0.15, (0.14, 0.16)))
    assert (joined.free.shape[1], apart.free.shape[1]) == (1, 2)
