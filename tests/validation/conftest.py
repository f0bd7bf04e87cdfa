"""Settings and claims that the tests of the validation share."""

import pickle
from dataclasses import replace
from functools import cache

import pytest

from validation.calibration import misuse, segmented_regression, shear_calibration, site_matching
from validation.paper import fig_s2_misalignment
from validation.results import evaluate
from validation.scenes import drift, stability_points
from validation.stability import random_scenes


@pytest.fixture(scope="session", autouse=True)
def few_scenes():
    """Evaluate claims whose numbers the README does not show with fewer scenes than the report takes."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(random_scenes, "SCENES", 300)
        patch.setattr(stability_points, "SIDE", 3)
        patch.setattr(stability_points, "WIDTHS", (0.3, 0.44))
        patch.setattr(stability_points, "SPREADS", (0.5,))
        patch.setattr(stability_points, "LAYERS", (0.3, 1.5))
        patch.setattr(shear_calibration, "SURFACES", 1000)
        # the bounds of the shares follow from the number of calibrations, and those of the quantiles from
        # the number of placements
        patch.setattr(drift, "REPETITIONS", 100)
        patch.setattr(misuse, "REPETITIONS", 100)
        patch.setattr(fig_s2_misalignment, "SHUFFLES", 200)
        patch.setattr(fig_s2_misalignment, "OTHERS", 100)
        patch.setattr(site_matching, "TRIALS", 60)
        patch.setattr(site_matching, "ROW_TRIALS", 20)
        # of as many measured laws: only the bound of each interval has a larger error
        patch.setattr(segmented_regression, "DRAWS", 100)
        yield


@pytest.fixture(scope="session")
def evaluated(once):
    """A function that returns a claim, with the captions in place of its figures.

    Each claim is evaluated once for all processes.
    """

    @cache
    def found(name):
        def fill(folder):
            claim = evaluate(name)
            captions = {title: picture.caption for title, picture in claim.figures.items()}
            plain = replace(claim, figures=captions, values={})
            (folder / "claim.pickle").write_bytes(pickle.dumps(plain))

        return pickle.loads((once(f"claim-{name}", fill) / "claim.pickle").read_bytes())

    return found


@pytest.fixture
def claim(request, evaluated):
    """The claim of a name."""
    return evaluated(request.param)
