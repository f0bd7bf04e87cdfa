"""Lines through the origin over a range of loads: met within 1 % at every load, or refused with what is."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.inversion.result import DOUBT

TALL, DEMO = mf.Limits(0.27), mf.Limits(0.12, offset=0.084)


def deviation(result):
    """Largest relative difference of A0 from the target's line, on loads between those of the design."""
    load = np.geomspace(*result.target.load_range, 300)
    return np.abs(result.law.model.curve(result.surface, load).area / result.target.line(load) - 1.0).max()


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(order=1)], ids=repr)
def test_a_line_is_met_within_a_hundredth(template, model):
    two = mf.BilinearLaw((6.0, 9.0), 0.08, (0.03, 0.3))
    for target, limits in ((mf.LinearLaw(6.87, (0.05, 0.2)), DEMO), (two, TALL)):
        result = mf.design(target, template, model, limits)
        assert result.status in (DesignStatus.REACHED, DesignStatus.REFINED)
        assert deviation(result) < 0.01
        assert result.misfit == pytest.approx(deviation(result), rel=0.3)  # at a hundred loads
        assert not any(note.warns for note in result.notes if note.quantity != DOUBT)
        end = target.line(target.last_load)
        for branch, fit in result.fits:
            assert fit.intercept == pytest.approx(branch.intercept, abs=0.01 * end)
