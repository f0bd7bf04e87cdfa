"""Settings of the tests of the validation."""

import pytest

from validation.stability import random_scenes


@pytest.fixture(scope="session", autouse=True)
def few_scenes():
    """Evaluate the claim of random scenes with some hundreds of them; the report takes ten thousand."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(random_scenes, "SCENES", 500)
        yield
