"""The fit of the pedestal's compliance against its table."""

import numpy as np
import pytest

import metafem as mf
from metafem.contact import cap_compliance
from validation.scenes import pedestals


def test_the_fit_keeps_its_error_on_the_whole_table():
    for ratio, *row in pedestals.TABLE:
        foot = np.sqrt(ratio * (2.0 - ratio))
        fitted = cap_compliance.pedestal_compliance(ratio, 1.0, foot * np.array(pedestals.FOOT_RATIOS))
        np.testing.assert_allclose(fitted, row, rtol=cap_compliance.FIT_ERROR)


# c_p [1/mm] at R = 0.526 mm of another small-strain computation, printed to two decimals, at contacts of
# about a tenth of R, with which the compliance changes by a few hundredths.
@pytest.mark.parametrize(("height", "printed"), [(0.12, 0.27), (0.20, 0.46), (0.27, 0.64)])
def test_other_computations_agree(height, printed):
    assert cap_compliance.pedestal_compliance(height, 0.526, 0.05) == pytest.approx(printed, abs=0.02)


def test_lengths_scale():
    assert cap_compliance.pedestal_compliance(0.2, 0.5, 0.1) == pytest.approx(
        10.0 * cap_compliance.pedestal_compliance(2.0, 5.0, 1.0), rel=1e-12
    )


@pytest.mark.parametrize(("height", "contact"), [(0.01, 0.0), (0.7, 0.0), (0.2, -0.1), (0.2, 0.5)])
def test_outside_the_table_is_refused(height, contact):
    with pytest.raises(mf.InvalidInput, match="must lie from"):
        cap_compliance.pedestal_compliance(height, 1.0, contact)
