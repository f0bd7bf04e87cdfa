"""Every variable of the studies of errors has a unit and a name."""

import pytest

import metafem as mf
from metafem.studies.sampling.dataset import described


@pytest.fixture(scope="module")
def surface():
    material, friction = mf.Material(1.36), mf.Friction(0.404, 0.85)
    height = [[0.1, 0.12], [0.11, 0.13]]
    return mf.Surface.square_lattice(height, (2, 2), radius=0.526, material=material, friction=friction)


def studies(surface):
    sd = {"radius": 0.005, "shear_strength": 0.006}
    yield mf.studies.manufacturing(surface, [0.001], draws=16)
    yield mf.studies.misalignment(surface, [0.0005, 0.001], shuffles=2)
    yield mf.studies.uncertainty(surface, sd, draws=16)
    yield mf.studies.uncertainty(surface, sd, draws=16, load=[0.1], friction_force=[0.2])


def test_every_variable_is_described(surface):
    for study in studies(surface):
        for name, variable in study.variables.items():
            if variable.dtype.kind == "f":
                assert variable.attrs["units"] in {"1", "mm", "mm2", "rad", "N"}, name
                assert variable.attrs["long_name"], name
    assert described("friction_force_sd")["units"] == "N"
    assert described("friction_force_total_error")["units"] == "1"
    assert described("nominal_area")["units"] == "mm2"
    assert described("anything_else") == {}
