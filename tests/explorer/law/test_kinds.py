"""Each kind of target begins near the law that is shown, and its surface exists."""

from dataclasses import replace

import numpy as np
import pytest

from metafem.errors import InvalidInput
from metafem.explorer.answer import answered
from metafem.explorer.law.kinds import KINDS, kind_of, with_kind
from metafem.explorer.law.nearest import with_nearest
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.files import all_keys, demo_text

TEXT = demo_text("operating-points")


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT), 1)


def test_all_kinds_of_specifications_can_be_chosen():
    kinds = {key.kind for key in all_keys() if key.section == "target"}
    assert set(KINDS) == kinds or kinds == set()


@pytest.mark.parametrize("newtons", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_another_kind_begins_near_the_law_that_is_shown(answer, kind, newtons):
    shown = replace(answer, state=State(TEXT, newtons=newtons))
    text = with_kind(shown, kind)
    assert kind_of(text) == kind
    assert (" N'" in str(Document(text).value("target"))) == (newtons and kind != "linear")
    found = answered(State(text), 2)
    assert found.current, found.refused
    before, after = answer.design.law, found.design.law
    load = np.linspace(0.3, 0.6, 10)
    laws = [np.interp(load, law.rescaled_load, law.area) for law in (before, after)]
    np.testing.assert_allclose(laws[1], laws[0], rtol=0.4)  # a line cannot follow the kink


def test_an_unknown_kind_is_refused_and_a_broken_text_has_none(answer):
    with pytest.raises(InvalidInput, match='kind = "cubic" is unknown'):
        with_kind(answer, "cubic")
    assert kind_of("[target") == ""


@pytest.mark.parametrize(
    "target",
    [
        'kind = "operating-points"\nrescaled_load = ["0.144 mm^2"]\nrescaled_friction = ["5.2 mm^2"]',
        'kind = "operating-points"\nload = ["200 mN", "0.8 N"]\nfriction_force = ["0.26 N", "3000 mN"]',
        'kind = "sampled"\nrescaled_load = ["0.1 mm^2"]\nrescaled_friction = ["0.1 mm^2"]',
        'kind = "linear"\nslope = 1.0',
        'kind = "linear"\nfriction_coefficient = 0.2',
        'kind = "linear"\nslope = 20.0\nload_range = ["0.1 mm^2", "0.4 mm^2"]',
        'kind = "bilinear"\nslopes = [1.0, 12.5]\ncrossover_load = "0.04 mm^2"',
        'kind = "power"\nexponent = 0.3\nload_range = ["0.1 mm^2", "0.4 mm^2"]',
    ],
)
def test_the_nearest_law_of_a_refusal_can_be_taken_as_the_target(target):
    text = f"[target]\n{target}\n\n{TEXT[TEXT.index('[material]') :]}"
    refused = answered(State(text), 1)
    assert refused.refusal
    if refused.nearest_target is None:
        with pytest.raises(InvalidInput, match="no nearest law is known"):
            with_nearest(refused)
        return
    found = answered(State(with_nearest(refused)), 2)
    assert found.current, found.refused
    assert kind_of(found.state.text) == kind_of(text)
    assert ("mN" in found.state.text) == ("mN" in text)
