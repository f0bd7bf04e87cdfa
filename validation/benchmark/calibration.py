"""Times of calibrations of contacts, against ODRPACK."""

from __future__ import annotations

from functools import partial

import numpy as np

from metafem.calibration import Bootstrap, Sample, fit_compression
from metafem.calibration.compression.distance_fit import adhesive_load
from metafem.calibration.compression.scene import cap_curve
from metafem.contact import Hertz
from validation.calibration.contact_calibration import TRIALS
from validation.scenes import compression_tests as scene
from validation.timing import Row, best

# Fits of which ODRPACK's mean time is taken.
SOME = 200


def rows() -> list[Row]:
    """Time many fits at once, the same by ODRPACK one by one, and one calibration with its tests."""
    load, area = scene.compression_tests(TRIALS, 5, scene.ENERGY, np.random.default_rng(0))
    test = np.repeat(np.arange(scene.TESTS), len(scene.RADII))
    options = {"sample": Sample(contacts=5, radius_sd=0.005), "test": test, "bootstrap": Bootstrap(1000, 0)}
    whole = partial(fit_compression, load[0], area[0], scene.RADIUS, **options)
    together = best(lambda: scene.fitted(load, area, 5), 3)
    alone = best(lambda: _odrpack(load[:SOME] / 5.0, area[:SOME] / 5.0), 1) * TRIALS / SOME
    return [
        Row(f"{TRIALS:,} fits of {load.shape[1]} points", 2.0, together, "s"),
        Row("the same over the time of ODRPACK, one by one", 0.2, together / alone, "1"),
        Row("a calibration with three tests and 1,000 draws", 1.0, best(whole, 3), "s"),
    ]


def _odrpack(load: np.ndarray, area: np.ndarray) -> None:
    """Fit sets of data with analytic derivatives."""
    import odrpack

    curve = cap_curve(Hertz(), scene.RADIUS).load_and_slope

    def law(x: np.ndarray, beta: np.ndarray) -> np.ndarray:
        return np.asarray(beta[0] * curve(x)[0] - beta[1] * adhesive_load(x)[0])

    def by_parameters(x: np.ndarray, beta: np.ndarray) -> np.ndarray:
        return np.stack([curve(x)[0], -adhesive_load(x)[0]])

    def by_area(x: np.ndarray, beta: np.ndarray) -> np.ndarray:
        return np.asarray(beta[0] * curve(x)[1] - beta[1] * adhesive_load(x)[1])

    for one, other in zip(load, area, strict=True):
        odrpack.odr_fit(
            law, other, one, np.array([1.0, 0.0]),
            weight_x=scene.ERRORS.of_area(other) ** -2, weight_y=(scene.ERRORS.load / 5.0) ** -2,
            jac_beta=by_parameters, jac_x=by_area,
        )  # fmt: skip
