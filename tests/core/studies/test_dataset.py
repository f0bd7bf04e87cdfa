"""Every variable of the studies of errors has a unit and a name."""

import metafem as mf
from metafem.prediction.base_law import described


def test_every_variable_is_described(surface):
    sd = {"radius": 0.005, "shear_strength": 0.006}
    for study in (
        mf.studies.manufacturing(surface, [0.001], draws=16),
        mf.studies.misalignment(surface, [0.0005, 0.001], shuffles=2),
        mf.studies.uncertainty(surface, sd, draws=16, load=[0.1]),
    ):
        for name, variable in study.variables.items():
            if variable.dtype.kind == "f":
                assert variable.attrs["units"] in {"1", "mm", "mm2", "rad", "N"}, name
                assert variable.attrs["long_name"], name
    units = {"friction_force_sd": "N", "friction_force_total_error": "1", "nominal_area": "mm2"}
    assert {name: described(name)["units"] for name in units} == units
    assert described("anything_else") == {}
