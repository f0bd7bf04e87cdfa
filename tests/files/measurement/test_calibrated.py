"""Parameters and covariance of a calibration in its file: files that are damaged are named."""

import json
from dataclasses import replace

import numpy as np
import pytest

from metafem.calibration import fit_compression
from metafem.errors import InvalidInput
from metafem.files.measurement.calibrated import KIND, calibration_data, read_parameters


@pytest.fixture
def written(tmp_path):
    """Return a file of a calibration with some entries."""

    def call(parameters, values, covariance):
        data = {"kind": KIND, "parameters": parameters, "values": values, "covariance": covariance}
        path = tmp_path / "calibration.json"
        path.write_text(json.dumps(data), "utf-8")
        return path

    return call


def test_values_and_covariance_are_read(written):
    found = read_parameters(written(["area_ratio"], [0.85], [[4e-6]]))
    assert (found.parameters, found.value.tolist(), found.sd.tolist()) == (("area_ratio",), [0.85], [2e-3])


@pytest.mark.parametrize(
    ("parameters", "values", "covariance"),
    [
        ([["area_ratio"]], [0.85], [[1.0]]),
        (["area"], [0.85], [[1.0]]),
        (["area_ratio"], [0.85, 1.0], [[1.0]]),
        (["area_ratio"], [0.85], [[-1.0]]),
        (["area_ratio"], ["much"], [[1.0]]),
        (3, [0.85], [[1.0]]),
    ],
)
def test_damaged_files_are_refused(written, parameters, values, covariance):
    with pytest.raises(InvalidInput, match=r"calibration\.json is damaged"):
        read_parameters(written(parameters, values, covariance))


@pytest.mark.parametrize("draws", [0, 1])
def test_a_bootstrap_of_which_no_two_draws_have_a_fit_has_no_spread(draws):
    a = np.linspace(0.08, 0.4, 5)
    found = fit_compression(1.36 * 4.0 / 3.0 * a**3 / 0.526, np.pi * a**2, 0.526)
    data = calibration_data(replace(found, bootstrap=np.ones((draws, 2))), None, ["a.csv"], {})
    assert data["compression_bootstrap_sd"] is None
