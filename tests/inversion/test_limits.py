"""Sites that stay empty, and sites whose heights are given."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.limits import Pins

TEMPLATE = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
LIMITS = mf.Limits(0.12, offset=0.08)


def test_sites_are_numbered_anew_without_the_empty_ones():
    pins = Pins.given(TEMPLATE, replace(LIMITS, pinned={np.int64(9): 0.15, 3: None, 0: 0.1}))
    assert dict(pins.pinned) == {0: 0.1, 3: None, 9: 0.15}
    assert list(pins.open) == [site for site in range(16) if site != 3]
    assert list(pins.open[pins.rows]) == [0, 9]
    assert list(pins.heights) == [0.1, 0.15]
    np.testing.assert_array_equal(pins.reduced.position, TEMPLATE.position[pins.open])


def test_the_order_of_the_other_sites_is_kept():
    pins = Pins.given(TEMPLATE, replace(LIMITS, pinned={3: None, 5: None}))
    permutation = np.random.default_rng(0).permutation(16)
    left = [site for site in permutation if site not in (3, 5)]
    assert list(pins.open[pins.placed(permutation)]) == left


def test_without_pins_the_template_is_the_given_one():
    pins = Pins.given(TEMPLATE, LIMITS)
    assert pins.reduced is TEMPLATE
    assert list(pins.placed(np.arange(16)[::-1])) == list(range(16))[::-1]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([3], r"pinned = \[3\] must be a mapping of site numbers to heights \[mm\] or None"),
        ({16: None}, r"pinned\[16\] is not a site: the template has the sites 0 to 15"),
        ({-1: None}, r"pinned\[-1\] is not a site"),
        ({2.0: None}, r"pinned\[2.0\] is not a site"),
        ({True: None}, r"pinned\[True\] is not a site"),
        ({2: 0.21}, r"pinned\[2\] = 0.21 must be at most 0.2, limits.offset \+ limits.max_height"),
        ({2: -0.01}, r"pinned\[2\] = -0.01 must be at least 0"),
        ({2: "high"}, r"pinned\[2\] = 'high' is not a number"),
        (dict.fromkeys(range(16)), "pinned leaves all 16 sites empty"),
    ],
)
def test_pins_that_do_not_fit_are_refused(given, words):
    with pytest.raises(mf.InvalidInput, match=words):
        Pins.given(TEMPLATE, replace(LIMITS, pinned=given))


def test_a_part_has_no_summit_of_height_0():
    part = TEMPLATE.replaced(block=mf.Block(20.0, 20.0, 7.0))
    with pytest.raises(mf.InvalidInput, match=r"pinned\[2\] = 0 is no summit of a part; write None"):
        Pins.given(part, replace(LIMITS, pinned={2: 0.0}))
