"""The nearest law of a refusal as the target."""

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.answer import answered
from metafem.explorer.law.nearest import with_nearest
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.files import demo_text

TEXT = demo_text("operating-points")


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
    assert Document(found.state.text).value("target.kind") == Document(text).value("target.kind")
    assert ("mN" in found.state.text) == ("mN" in text)
