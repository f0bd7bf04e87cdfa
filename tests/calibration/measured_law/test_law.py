"""Measured laws: error bars, order, tables, and what they share with predicted laws."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem.calibration import ContactTable, MeasuredLaw, MeasurementErrors
from metafem.prediction.base_law import BaseLaw

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.404, 0.85)


def law_of(**changed):
    return MeasuredLaw(
        **{"load": [0.2, 0.1, 0.3], "friction_force": [0.09, 0.05, 0.13], "material": MATERIAL}
        | {"friction": FRICTION}
        | changed
    )


def test_the_points_are_rescaled_with_the_errors_of_the_paper():
    law = law_of()
    np.testing.assert_array_equal(law.load, [0.1, 0.2, 0.3])  # in order of load
    np.testing.assert_array_equal(law.friction_force, [0.05, 0.09, 0.13])
    np.testing.assert_allclose(law.rescaled_load, law.load / 1.36)
    np.testing.assert_allclose(law.rescaled_load_sd, 5e-3 / 1.36)
    np.testing.assert_allclose(law.rescaled_friction, law.friction_force / (0.404 * 0.85))
    np.testing.assert_allclose(law.rescaled_friction_sd, (1e-3 + 0.01 * law.friction_force) / (0.404 * 0.85))
    np.testing.assert_allclose(law.friction_coefficient, law.friction_force / law.load)


@given(st.permutations(range(5)))
def test_the_order_of_the_rows_does_not_matter(order):
    load, force = np.array([0.1, 0.2, 0.3, 0.4, 0.5]), np.array([0.05, 0.09, 0.13, 0.16, 0.2])
    rows = list(order)
    shuffled = law_of(load=load[rows], friction_force=force[rows], load_sd=0.01 * load[rows])
    assert shuffled == law_of(load=load, friction_force=force, load_sd=0.01 * load)
    assert hash(shuffled) == hash(law_of(load=load, friction_force=force, load_sd=0.01 * load))


def test_areas_take_the_place_of_forces():
    areas = np.array([[0.1, 0.0], [0.2, 0.05]])
    law = MeasuredLaw([0.1, 0.2], asperity_area=areas, site=[7, 3], material=MATERIAL)
    np.testing.assert_allclose(law.rescaled_friction, [0.1, 0.25])
    # independent boundaries: the squares of the contacts' errors add up to that of their total area
    np.testing.assert_allclose(law.area_sd, MeasurementErrors().of_area(law.area), rtol=1e-12)
    with pytest.raises(mf.InvalidInput, match="was not measured"):
        _ = law.friction_coefficient
    beside = MeasuredLaw([0.1, 0.2], area=law.area, material=MATERIAL, friction=FRICTION)
    np.testing.assert_allclose(beside.friction_coefficient, 0.404 * 0.85 * law.area / law.load)


def test_a_measured_and_a_predicted_law_have_the_same_fit_and_tables(template):
    predicted = mf.friction_law(template, load=np.linspace(0.1, 0.5, 9))
    measured = MeasuredLaw(
        predicted.load,
        friction_force=predicted.friction_force,
        material=template.material,
        friction=template.friction,
    )
    assert isinstance(predicted, BaseLaw)
    one, other = predicted.fit(load=(0.1, 0.5)), measured.fit(load=(0.1, 0.5))
    assert one.slope == pytest.approx(other.slope, rel=1e-12)
    shared = set(predicted.to_dataframe()) & set(measured.to_dataframe())
    assert {"load_N", "rescaled_load_mm2", "friction_force_N", "friction_coefficient"} <= shared
    for name in shared:
        np.testing.assert_allclose(measured.to_dataframe()[name], predicted.to_dataframe()[name], rtol=1e-12)
    assert measured.to_xarray()["load_sd"].attrs["units"] == "N"


def test_asperities_are_in_the_data_set():
    law = law_of(asperity_area=[[0.1, 0.2], [0.0, np.nan], [0.2, 0.3]], site=[4, 2])
    data = law.to_xarray()
    assert data.asperity_area.sel(site=2).values.tolist()[1:] == [0.2, 0.3]
    assert np.isnan(data.asperity_area.sel(site=2).values[0])
    np.testing.assert_allclose(law.area, [np.nan, 0.3, 0.5])


@pytest.mark.parametrize("units", ["N", "mm^2"])
def test_points_are_drawn_with_error_bars(units):
    ax = law_of().plot(units=units, label="part 1")
    assert len(ax.containers) == 1
    assert ax.containers[0].has_xerr
    assert ax.containers[0].has_yerr


def contacts(**changed):
    one = np.array([[0.1, 0.2], [0.05, 0.0], [0.3, 0.4]])
    arrays = {
        "image": ("a", "b", "c"), "test": ("", "", ""), "load": np.array([0.2, 0.1, 0.3]),
        "friction_force": np.full(3, np.nan), "position": np.zeros((2, 2)), "site": np.array([5, 2]),
        "matched": True, "area": one, "area_error": 0.01 * one,
        "sheared_area": np.full((3, 2), np.nan), "sheared_area_error": np.full((3, 2), np.nan),
    }  # fmt: skip
    return ContactTable(**arrays | changed)


def test_the_contacts_of_images_become_a_law():
    law = MeasuredLaw.from_contacts(contacts(), MATERIAL)
    np.testing.assert_allclose(law.area, [0.05, 0.3, 0.7])
    np.testing.assert_allclose(law.area_sd, [5e-4, np.hypot(1e-3, 2e-3), np.hypot(3e-3, 4e-3)])
    assert law.site.tolist() == [5, 2]


def test_images_without_a_load_a_force_or_an_area_are_left_out_and_named():
    forces = np.array([0.1, 0.05, np.nan])
    law = MeasuredLaw.from_contacts(contacts(friction_force=forces), MATERIAL, FRICTION)
    np.testing.assert_allclose(law.friction_force, [0.05, 0.1])
    assert [note.text for note in law.notes] == ["image c is left out: it has no friction force"]
    merged = np.array([[0.1, np.nan], [0.05, 0.0], [0.3, 0.4]])
    law = MeasuredLaw.from_contacts(contacts(area=merged, area_error=0.01 * merged), MATERIAL)
    assert len(law.load) == 3
    assert np.isnan(law.area[1])
    assert [note.text for note in law.notes] == [
        "image a: the area of the contact at site 2 is unknown; the other contacts are used"
    ]
    merged[2, 1] = np.nan
    law = MeasuredLaw.from_contacts(contacts(area=merged, area_error=0.01 * merged), MATERIAL)
    assert law.notes[0].text.startswith("2 images, a to c: the area of the contact at site 2 is unknown")
    merged[2, 1] = 0.4
    unmatched = contacts(area=merged, area_error=0.01 * merged, matched=False)
    notes = MeasuredLaw.from_contacts(unmatched, MATERIAL).notes
    assert [note.text for note in notes] == ["image a is left out: it has no area of contact 2"]
    with pytest.raises(mf.InvalidInput, match="none of the 3 images has a load"):
        MeasuredLaw.from_contacts(contacts(load=np.full(3, np.nan)), MATERIAL)


def test_areas_that_images_do_not_show_are_noted():
    table = contacts(area_error=np.array([[0.01, 0.01], [0.01, 0.006], [0.01, 0.01]]))
    law = MeasuredLaw.from_contacts(table, MATERIAL)
    assert law.asperity_area_sd[0].tolist() == [0.01, 0.006]
    assert law.notes[0].text.startswith("contacts of less than 0.006 mm^2 count as open")


def test_loads_with_an_unknown_contact_are_used_for_what_they_tell():
    load = np.linspace(0.02, 0.2, 10)
    whole = MeasuredLaw(load, asperity_area=np.outer(load, [1.0, 2.0]), material=MATERIAL)
    areas = np.vstack([np.outer(load, [1.0, 2.0]), [[0.3, np.nan]]])
    law = MeasuredLaw(np.append(load, 0.1), asperity_area=areas, material=MATERIAL)
    assert np.isnan(law.area).sum() == np.isnan(law.area_sd).sum() == 1
    np.testing.assert_array_equal(law.known().area, whole.area)
    np.testing.assert_array_equal(replace(law, label="a copy").area, law.area)
    assert law.fit(load=(0.02, 0.2)).slope == whole.fit(load=(0.02, 0.2)).slope
    forces = replace(law, friction_force=0.3 * law.load, friction=FRICTION)
    assert len(forces.known().load) == 11
    nowhere = MeasuredLaw(load, asperity_area=np.outer(load, [1.0, np.nan]), material=MATERIAL)
    with pytest.raises(mf.InvalidInput, match="the contact area is unknown at every load"):
        nowhere.known()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"friction_force": None}, "needs friction_force, area or asperity_area"),
        ({"friction": None}, "rescaled with the friction"),
        ({"material": 1.36}, "must be a metafem.Material"),
        ({"load_sd": [0.0, 1.0, 1.0]}, r"load_sd\[0\] = 0 must be greater than 0"),
        ({"load": [-0.2, 0.1, 0.3]}, r"load\[0\] = -0.2 is below 0 by 40 standard deviations"),
        ({"friction_force": [0.1, 0.2]}, "friction_force has 2 numbers"),
        ({"area_sd": [0.1, 0.1, 0.1]}, "area_sd needs area"),
        ({"site": [1, 2]}, "site needs asperity_area"),
        ({"asperity_area": np.ones((3, 2)), "site": [1, 1]}, "site holds 1 twice"),
        ({"asperity_area": -np.ones((3, 2))}, r"asperity_area\[0, 0\] = -1 must be at least 0"),
        ({"friction_force": None, "area": [0.1, np.nan, 0.3]}, r"area\[1\] = nan must be a number"),
        ({"area": [0.0, 0.0, 0.0]}, "there is no contact"),
    ],
)  # fmt: skip
def test_what_is_no_law_is_refused_by_name(changed, words):
    with pytest.raises(mf.InvalidInput, match=words):
        law_of(**changed)
