"""Sites that stay empty, and sites whose heights are given."""

from dataclasses import replace

import numpy as np

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
