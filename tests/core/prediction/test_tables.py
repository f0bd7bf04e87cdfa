"""Laws as tables of pandas and xarray."""

import numpy as np
import pytest

import metafem as mf


@pytest.fixture
def law(template):
    return mf.friction_law(template, load=[0.1, 0.2, 0.3])


def test_a_table_holds_every_quantity_with_its_unit(law):
    table = law.to_dataframe()
    expected = {
        "load_N": law.load,
        "area_mm2": law.area,
        "separation_mm": law.separation,
        "rescaled_load_mm2": law.rescaled_load,
        "rescaled_friction_mm2": law.area,
        "friction_force_N": law.friction_force,
        "friction_coefficient": law.friction_coefficient,
        "approach_mm": law.approach,
        "stiffness_N_per_mm": law.stiffness,
        "residual": law.residual,
    }
    assert list(table) == list(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(table[name], values)
    assert table.attrs["model"] == "Independent()"
    assert table.attrs["status"].startswith("converged")


def test_a_data_set_has_units_and_is_written(law, tmp_path):
    import xarray as xr

    data = law.to_xarray()
    assert dict(data.sizes) == {"rescaled_load": 3}
    np.testing.assert_array_equal(data.friction_force, law.friction_force)
    units = {name: data[name].attrs["units"] for name in ("rescaled_load", "load", "area", "stiffness")}
    assert units == {"rescaled_load": "mm2", "load": "N", "area": "mm2", "stiffness": "N/mm"}
    data.to_netcdf(tmp_path / "law.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "law.nc", engine="h5netcdf") as again:
        assert again.identical(data)
