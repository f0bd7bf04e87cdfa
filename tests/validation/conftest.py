"""Settings of the tests of the validation."""

import pytest

from validation.scenes import stability_points
from validation.stability import random_scenes


@pytest.fixture(scope="session", autouse=True)
def few_scenes():
    """Evaluate the claims of the stability with fewer scenes than the report takes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(random_scenes, "SCENES", 300)
        patch.setattr(stability_points, "SIDE", 3)
        patch.setattr(stability_points, "WIDTHS", (0.3, 0.44))
        patch.setattr(stability_points, "SPREADS", (0.5,))
        patch.setattr(stability_points, "LAYERS", (0.3, 1.5))
        yield
