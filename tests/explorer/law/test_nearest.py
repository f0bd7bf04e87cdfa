"""The nearest law as the target of a text."""

from dataclasses import replace

import pytest

from metafem.explorer.answer import answered
from metafem.explorer.law.nearest import offer, with_nearest
from metafem.explorer.session import State
from metafem.files import demo_text, parsed
from metafem.inversion import OperatingPoints

FORCES = """[target]
kind = "operating-points"
load = ["0.2 N", "0.4 N", "0.6 N"]
friction_force = ["0.3 N", "0.9 N", "1.0 N"]
"""


@pytest.mark.parametrize("forces", [False, True])
def test_a_nearest_law_that_ends_earlier_can_be_designed_in_the_units_of_the_text(forces):
    demo = demo_text("operating-points")
    by_forces, rescaled = FORCES + demo[demo.index("[material]") :], demo.replace('"1.68 mm^2"', '"2.9 mm^2"')
    text = by_forces if forces else rescaled
    refused = answered(State(text), 1)
    assert refused.nearest_target is not None
    found = with_nearest(refused)
    assert answered(State(found), 2).current
    wanted = refused.nearest_target.rescaled_friction
    assert parsed(found).target.rescaled_friction == pytest.approx(wanted, rel=1e-8)
    assert ("friction_force = " in found.partition("#")[0]) == forces


def test_a_button_says_which_points_it_moves_or_drops():
    demo = demo_text("operating-points")
    wanted = (
        ('"1.68 mm^2"', '"2.9 mm^2"', "Move point 2 to the nearest law"),
        ('"4.12 mm^2"', '"14.12 mm^2"', "Move point 3 to the nearest law"),
        ('max_height = "270 um"', 'max_height = "120 um"', ""),
    )
    for old, new, words in wanted:
        refused = answered(State(demo.replace(old, new)), 1)
        assert refused.refusal
        assert offer(refused) == words
    short = replace(refused, nearest_target=OperatingPoints([0.144, 0.336], [0.84, 1.7]))
    assert offer(short) == "Move point 2 to the nearest law and drop point 3"
