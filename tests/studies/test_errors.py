"""Studies of errors: their intervals, many angles, an angle without a solution, and processes of Dask."""

import subprocess
import sys

import numpy as np
import pytest

import metafem as mf

# Share of the studies within one standard error, and their number.
EXPECTED, REPETITIONS = 0.683, 100

PAIR = mf.Surface.square_lattice(
    [0.1, 0.105, 0.11, 0.13], (2, 2), radius=0.526, material=mf.Material(composite_modulus=1.36)
)
MOMENTS = ("slope_mean", "slope_sd", "area_mean", "area_sd")


def test_errors_cover_the_mean_of_many_studies():
    last = []
    for seed in range(REPETITIONS):
        study = mf.studies.manufacturing(PAIR, 0.003, draws=512, load_range=(0.005, 0.02), rng=seed)
        last.append(
            [[study[f"{name}{end}"].values.ravel()[-1] for end in ("", "_error")] for name in MOMENTS]
        )
    value, error = np.moveaxis(np.array(last), -1, 0)
    share = (np.abs(value - value.mean(axis=0)) <= error).mean(axis=0)
    assert share == pytest.approx(EXPECTED, abs=3.0 * np.sqrt(EXPECTED * (1.0 - EXPECTED) / REPETITIONS))


RANGE = (0.02, 0.1)


def test_a_number_is_a_thousand_steps_of_the_source(surface):
    found = mf.studies.misalignment(surface, 0.001, load_range=RANGE)
    assert found.sizes["angle"] == 1000
    few = mf.studies.misalignment(surface, np.linspace(0.0, 0.001, 101)[1:], load_range=RANGE)
    same = found.isel(angle=slice(9, None, 10))
    np.testing.assert_allclose(same["angle"], few["angle"])
    np.testing.assert_allclose(same.slope_sd, few.slope_sd, rtol=0.01)


def test_an_angle_without_a_solution_is_named(surface, monkeypatch):
    areas = mf.Independent.areas

    def failing(*given):
        found = areas(*given)
        found[0, 2] = np.nan
        return found

    monkeypatch.setattr(mf.Independent, "areas", failing)
    with pytest.raises(mf.NotConverged, match=r"at a tilt of -0\.002 rad"):
        mf.studies.misalignment(surface, [0.001, 0.002])


CLUSTER = """
import joblib
from distributed import Client, LocalCluster
from tests.core.studies.test_draws import study

if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster):
        with joblib.parallel_config("dask"):
            found = study()
    assert found.identical(study())
"""


def test_a_cluster_gives_the_same_numbers():
    subprocess.run([sys.executable, "-c", CLUSTER], timeout=120, check=True)
