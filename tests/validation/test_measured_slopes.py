"""The slopes of Figs. 4 and 5 by three contact laws, and the verdict that is made of them."""

import numpy as np
import pytest

from validation.paper import measured_slopes as table
from validation.verdicts import FOLLOWING, Evidence


@pytest.mark.parametrize(
    ("hertz", "words"), [(0.5, "For the slopes of Fig. 4, yes"), (1.2, "Not for the slopes")]
)
def test_the_verdict_is_no_where_hertz_misses_a_measured_slope(hertz, words):
    evidence = Evidence({})
    known = {"hertz": hertz, "hertz_5": 4.0, "within": 0.052}
    assert FOLLOWING["contacts"](evidence, known)["enough"].startswith(words)
    assert evidence.partly == (hertz > 1.0)


def test_refitted_strength_leaves_the_forces_as_they_are():
    area = np.array([1.0, 1.5, 1.9])
    for ratio in (0.8, 1.0, 1.3):
        np.testing.assert_allclose(table.refitted(area, ratio * area) * ratio * area, area)


@pytest.mark.slow
def test_every_printed_slope_is_compared():
    found = table.branches()
    assert [found[f"Fig. 4 {colour}"][2:] for colour in ("blue", "red")] == [(9.53, 0.25), (6.73, 0.22)]
    assert sorted(each[2] for name, each in found.items() if "5" in name) == [7.15, 7.15, 12.52, 12.52]


def test_full_contact_begins_where_the_lowest_asperity_touches():
    surface = "Fig. 4 blue"
    height = table.surfaces()[surface].height
    # Hertz's loads of indentations from the lowest summit
    expected = 4.0 / 3.0 * np.sqrt(table.RADIUS) * ((height - height.min()) ** 1.5).sum()
    assert table.full_contact(surface)[[0, -1]] == pytest.approx([expected, 2.0 * expected])


@pytest.mark.slow
def test_hertz_fits_a_smaller_modulus_to_adhesive_contacts():
    assert table.softening(1.36) == pytest.approx(0.972, abs=0.002)
    assert table.softening(1e9) == pytest.approx(1.0, abs=1e-4)  # stiff contacts are those without adhesion
