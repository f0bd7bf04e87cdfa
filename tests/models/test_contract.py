"""The contract of the models that `tests/core` leaves out."""

import pytest
from hypothesis import settings

from tests.core.models.test_contract import (
    EVERY,
    FIRST,
    RANDOM_SCENES,
    Contract,
    assert_converges,
    named,
)


class TestContract(Contract):
    @pytest.fixture(params=[model for model in EVERY if model not in FIRST], ids=named)
    def model(self, request):
        return request.param


@settings(max_examples=200)
@RANDOM_SCENES
def test_many_random_scenes_converge(count, seed, approach, spread, decades, model):
    assert_converges(count, seed, approach, spread, decades, model)
