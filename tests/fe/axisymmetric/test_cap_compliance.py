"""The measured compliance of the pedestal, and the fit between the rows of its table."""

import math

import pytest

import metafem as mf
from metafem.contact.cap_compliance import pedestal_compliance
from metafem.fe.axisymmetric import cap_compliance


def test_shortfall_of_the_block_without_a_cap():
    contact = mf.fe.press(10.0, 1.0, thickness=cap_compliance.EXTENT, block_radius=cap_compliance.EXTENT)
    hertz = (0.75 * contact.rescaled_load) ** (2.0 / 3.0)
    short = math.pi * (hertz - contact.indentation) / contact.rescaled_load
    assert short * cap_compliance.EXTENT == pytest.approx(cap_compliance.SHORTFALL, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("height_ratio", [0.06, 0.23, 0.57])
def test_the_fit_holds_between_the_rows(height_ratio):
    a = 0.3 * math.sqrt(height_ratio * (2.0 - height_ratio))
    # The promise of the table.
    assert pedestal_compliance(height_ratio, 1.0, a) == pytest.approx(
        mf.fe.measure_pedestal(height_ratio, a), rel=1e-3
    )


def test_a_contact_beyond_the_cap_is_refused():
    with pytest.raises(mf.InvalidInput, match="cap's edge"):
        mf.fe.measure_pedestal(0.1, 0.5)
