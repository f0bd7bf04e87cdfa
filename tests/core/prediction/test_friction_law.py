"""The friction law and the fits of its branches."""

import numpy as np
import pytest
from scipy import stats

import metafem as mf
from metafem.prediction import law_of_curve
from metafem.prediction.validity import base_contact_load
from tests.models.scenes import said


def test_law_agrees_with_single_equilibria_in_any_order(rough):
    law = mf.friction_law(rough, load=[0.4, 0.1])
    for i, load in enumerate((0.1, 0.4)):
        state = mf.equilibrium(rough, load=load)
        assert state.load == pytest.approx(load, rel=1e-12)
        computed = law.load[i], law.area[i], law.separation[i], law.stiffness[i]
        assert computed == pytest.approx((load, state.area, state.separation, state.stiffness), rel=1e-12)


def test_law_by_separation_is_the_same_curve(rough):
    law = mf.friction_law(rough, load=np.linspace(0.05, 0.5, 7))
    again = mf.friction_law(rough, separation=law.separation)
    np.testing.assert_allclose(again.load, law.load, rtol=1e-12)
    np.testing.assert_allclose(again.area, law.area, rtol=1e-12)


def test_default_grid_brings_every_asperity_into_contact(rough):
    law = mf.friction_law(rough)
    last = mf.equilibrium(rough, load=float(law.load[-1]))
    assert len(law.load) == 100
    assert (last.asperity_area > 0.0).all()
    assert last.separation > 0.0


def test_fit_is_the_regression_with_its_interval(rough):
    law = mf.friction_law(rough, load=np.linspace(0.1, 0.6, 26))
    fit = law.fit((0.1, 0.4))
    inside = (law.rescaled_load >= 0.1) & (law.rescaled_load <= 0.4)
    line = stats.linregress(law.rescaled_load[inside], law.rescaled_friction[inside])
    student = stats.t.ppf(0.84, inside.sum() - 2)
    assert fit.points == inside.sum()
    assert (fit.slope, fit.intercept) == pytest.approx((line.slope, line.intercept), rel=1e-9)
    assert fit.slope_interval[1] - fit.slope == pytest.approx(student * line.stderr, rel=1e-9)
    assert fit.intercept - fit.intercept_interval[0] == pytest.approx(
        student * line.intercept_stderr, rel=1e-9
    )


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(3, mf.BondedLayer())])
def test_the_load_at_which_the_plane_reaches_the_base_is_stated(rough, model):
    onset = rough.material.composite_modulus * base_contact_load(rough, model)
    state = mf.equilibrium(rough, model, load=onset)
    assert abs(state.base_gap) < 1e-8
    if model == mf.Independent():
        assert state.separation == pytest.approx(0.0, abs=1e-12)
    for load in ([1.5 * onset, 2.0 * onset], [0.5 * onset, 2.0 * onset]):
        for result in (mf.friction_law(rough, model, load=load), mf.equilibrium(rough, model, load=load[1])):
            assert f"would touch from a load of {onset:.4g} N on" in said(result)
    assert "base plane" not in said(mf.friction_law(rough, model, load=[0.999 * onset]))
    assert "base plane" not in said(mf.equilibrium(rough, model, load=0.999 * onset))


def test_contacts_too_wide_for_the_models_are_stated(rough):
    for model in [mf.Independent(), mf.Interacting()]:
        high = rough.replaced(height=rough.height + 0.3)
        state = mf.equilibrium(high, model, separation=0.25)
        ratio = np.sqrt(state.asperity_area.max() / np.pi) / 0.526
        text = f"the widest contact has a/R = {ratio:.2f} at {state.load:.4g} N"
        assert text in said(mf.friction_law(high, model, load=[0.1, state.load]))
        assert text in said(state)
        assert "a/R" not in said(mf.friction_law(high, model, load=[0.01]))


def test_friction_coefficient_is_friction_over_load(rough):
    law = mf.friction_law(rough, load=[0.0, 0.2, 0.4])
    np.testing.assert_array_equal(law.friction_coefficient[1:], law.friction_force[1:] / law.load[1:])
    assert law.friction_coefficient[0] == np.inf


def test_fits_are_in_newtons_too(rough):
    law = mf.friction_law(rough, load=np.linspace(0.1, 0.6, 26))
    fit = law.fit(load=(0.136, 0.544))
    assert fit.load_range == pytest.approx((0.1, 0.4), rel=1e-12)
    inside = (law.load >= 0.136) & (law.load <= 0.544)
    slope, intercept = np.polyfit(law.load[inside], law.friction_force[inside], 1)
    assert fit.friction_coefficient == pytest.approx(slope, rel=1e-9)
    assert fit.intercept_force == pytest.approx(intercept, rel=1e-9)
    plain = mf.friction_law(rough.replaced(friction=None), load=law.load).fit((0.1, 0.4))
    assert (plain.friction_coefficient, plain.intercept_force) == (None, None)


def test_a_fit_holds_the_loads_at_the_ends_of_its_range(rough):
    for modulus in [0.7, 3.3e5]:
        surface = rough.replaced(material=mf.Material(modulus))
        for ends in ((0.1, 0.7), (0.03, 0.3)):
            load = np.linspace(*ends, 26)
            curve = mf.Independent().curve(surface, load)
            assert law_of_curve(surface, mf.Independent(), curve, load).fit(ends).points == 26
            newtons = modulus * np.linspace(*ends, 26)
            law = mf.friction_law(surface, load=newtons)
            assert law.fit(load=(newtons[0], newtons[-1])).points == 26


def test_the_default_loads_end_where_the_contact_law_does():
    for order in [None, 1]:
        d = np.array([0.001, 0.01, 0.03])
        table = mf.TabulatedContact(d, 1.36 * 4 / 3 * 0.526**0.5 * d**1.5, np.pi * 0.526 * d)
        model = mf.Independent(contact=table) if order is None else mf.Interacting(order=order, contact=table)
        surface = mf.Surface.square_lattice(
            [0.1, 0.11, 0.12, 0.1], (2, 2), radius=0.526, material=mf.Material(1.36)
        )
        law = mf.friction_law(surface, model)
        state = mf.equilibrium(surface, model, load=float(law.load[-1]))
        assert 0.95 * 0.03 < np.sqrt(state.asperity_area.max() / np.pi) ** 2 / 0.526 < 0.03


def test_loads_and_forces_per_area_of_a_periodic_cell(rough):
    law = mf.friction_law(rough.replaced(cell=mf.PeriodicCell(12.0, 15.0)), load=[0.2])
    table = law.to_dataframe()
    np.testing.assert_allclose(table["nominal_pressure_MPa"], 0.2 / 180.0, rtol=1e-12)
    np.testing.assert_allclose(table["nominal_shear_stress_MPa"], law.friction_force / 180.0, rtol=1e-12)


def test_units_are_suspected_of_moduli_and_loads_that_rubber_does_not_have():
    lattice = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    rubber, stiff = lattice, lattice.replaced(material=mf.Material(3300.0))
    for surface, load, words in (
        (stiff, [100.0, 400.0], ["E* = 3300 MPa, but rubbers and gels have 0.01 to 100 MPa: check its unit"]),
        (rubber, [1e-4, 4e-4], ["the widest contact has only a/R = 0.06: check the units"]),
        (rubber, [0.1, 0.4], []),
    ):
        warned = [str(note) for note in mf.friction_law(surface, load=load).notes if "check" in str(note)]
        assert len(warned) == len(words)
        assert all(part in note for part, note in zip(words, warned, strict=True))


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
