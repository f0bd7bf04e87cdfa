from dataclasses import replace

import numpy as np
import pytest

from metafem.calibration import DesignSites, track_contacts
from metafem.errors import InvalidInput
from metafem.notes import Note
from tests.calibration.sites.scenes import contacts
from validation.scenes.lattice_views import lattice, seen

SITES = lattice()


def loading(seed=0, images=6, drift=0.2, mirrored=False):
    """Return the images of a loading of a lattice, and the exact areas (k, 64) [mm²]."""
    rng = np.random.default_rng(seed)
    entry = rng.permutation(64)  # the image in which each contact closes
    where = seen(SITES, turn=0.05, scale=0.96, shift=(7.0, 7.0), mirrored=mirrored)
    found, exact = [], np.zeros((images, 64))
    for i in range(images):
        closed = np.flatnonzero(entry < 64 * (i + 1) // images)
        exact[i, closed] = np.pi * (0.05 + 0.004 * (i * 10 + entry[closed] % 7)) ** 2
        order = rng.permutation(closed)
        shift = rng.uniform(-drift, drift, 2)
        centre = where[order] + shift + 0.003 * rng.normal(size=(len(order), 2))
        found.append(contacts(centre, np.sqrt(exact[i, order] / np.pi)))
    return found, exact


@pytest.mark.parametrize("mirrored", [False, True])
def test_areas_stand_at_their_sites_in_all_images(mirrored):
    found, exact = loading(mirrored=mirrored)
    names = [f"{i}.tif" for i in range(6)]
    tracked = track_contacts(
        found,
        names,
        load=0.1 * np.arange(6),
        sites=DesignSites(SITES, viewed_from="block" if mirrored else "glass"),
    )
    table = tracked.table
    np.testing.assert_allclose(table.area, exact, rtol=1e-12)
    np.testing.assert_allclose(table.area_error, 0.01 * exact, rtol=1e-12)
    assert tracked.reference == 5
    assert table.matched
    assert table.site.tolist() == list(range(64))
    assert table.remarks == ()
    assert np.isnan(table.sheared_area).all()
    np.testing.assert_array_equal(table.position, SITES)
    for areas, placed in zip(found, tracked.placed, strict=True):
        distance = np.linalg.norm(areas.centre - placed.position[placed.site], axis=1)
        assert distance.max() < 0.03


def test_numbers_of_sites_are_those_given():
    few = np.arange(3, 64, 2)
    areas = contacts(seen(SITES[few])[::-1], 0.1 + 0.001 * few[::-1])
    table = track_contacts([areas], ["a"], sites=DesignSites(SITES[few], few)).table
    assert table.site.tolist() == few.tolist()
    np.testing.assert_allclose(table.area[0], np.pi * (0.1 + 0.001 * few) ** 2, rtol=1e-12)


def test_without_sites_contacts_are_numbered_and_followed():
    """Five caps 7.1 mm apart, in the order in which the fullest image shows them."""
    caps = 2.0 + 7.1 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]])
    rng = np.random.default_rng(1)
    shifts = rng.uniform(-0.5, 0.5, (4, 2))
    shifts[-1] = 0.0
    closed = [[2], [2, 4], [4, 2, 0, 1], [0, 1, 2, 3, 4]]
    found = [contacts(caps[c] + d, 0.1 + 0.01 * np.array(c)) for c, d in zip(closed, shifts, strict=True)]
    tracked = track_contacts(found, list("abcd"), test=["1"] * 4)
    exact = np.zeros((4, 5))
    for i, c in enumerate(closed):
        exact[i, c] = np.pi * (0.1 + 0.01 * np.array(c)) ** 2
    np.testing.assert_allclose(tracked.table.area, exact, rtol=1e-12)
    np.testing.assert_allclose(tracked.table.position, caps, atol=1e-12)
    assert not tracked.table.matched
    assert tracked.match is None
    assert tracked.table.test == ("1",) * 4


def test_an_image_without_load_does_not_number_the_contacts():
    other = contacts(np.random.default_rng(0).uniform(0.5, 13.5, (90, 2)), 0.2)
    own = contacts(seen(SITES), 0.3)
    assert track_contacts([other, own], ["a", "b"], load=[np.nan, 1.0]).reference == 1
    assert track_contacts([other, own], ["a", "b"]).reference == 0


def test_sheared_images_move_with_their_contacts():
    found, exact = loading(drift=0.05)
    moved = [
        None if i % 2 else replace(one, centre=one.centre + np.array([0.4, 0.1]), area=0.85 * one.area)
        for i, one in enumerate(found)
    ]
    table = track_contacts(found, list("abcdef"), sheared=moved, sites=DesignSites(SITES)).table
    np.testing.assert_allclose(table.sheared_area[::2], 0.85 * exact[::2], rtol=1e-12)
    assert np.isnan(table.sheared_area[1::2]).all()


def test_a_shift_by_more_than_half_a_pitch_is_found_where_the_whole_lattice_is_seen():
    found, exact = loading(drift=0.0)
    moved = [replace(one, centre=one.centre + np.array([1.0, 0.0]), shape=(1400, 1600)) for one in found]
    table = track_contacts([*found, moved[-1]], list("abcdefg"), sites=DesignSites(SITES)).table
    np.testing.assert_allclose(table.area[-1], exact[-1], rtol=1e-12)


def cropped():
    """Return two images of a lattice whose frame cuts two large contacts, its sites, and the closed ones."""
    where = seen(SITES)
    closed = [0, 9, 18, 33, 45, 50, 39, 63]
    few = contacts(where[closed], 0.02 + 0.001 * np.arange(8))
    centre = where.copy()
    centre[[39, 63], 0] -= 0.07  # the centre of the part that is seen
    return few, contacts(centre, 0.2, edge=[39, 63]), where, closed


def test_contacts_cut_by_the_frame_at_large_load_do_not_shift_the_others():
    few, full, where, closed = cropped()
    table = track_contacts([few, full], ["a", "b"]).table
    assert len(table.site) == 64
    exact = few.area[np.argsort(closed)]
    near = np.array([np.argmin(np.hypot(*(where - p).T)) for p in table.position])
    measured = table.area[0] > 0.0
    assert near[measured].tolist() == sorted(closed)
    np.testing.assert_allclose(table.area[0, measured], exact, rtol=1e-12)
    lost = np.isnan(table.area[1])
    assert near[lost].tolist() == [39, 63]
    alone = track_contacts([full], ["b"]).table
    assert len(alone.site) == 62
    assert alone.remarks == ("b: 2 regions at the edge of the frame or merged, with 0.251 mm², not numbered",)


def test_contacts_that_no_image_shows_whole_count_for_the_shift():
    """The lowest row is cut by the frame in both images, one of which may have no other contacts."""
    where = seen(SITES)
    full = contacts(where, 0.2, edge=range(8))
    few = contacts(where[[1, 2, 3, 4, 5, 9, 18]], 0.1, edge=range(5))
    rest = contacts(where[[3, 4]], 0.1, edge=range(2))
    table = track_contacts([rest, few, full], ["a", "b", "c"]).table
    assert np.flatnonzero(table.area[1] > 0.0).tolist() == [1, 10]
    assert np.nansum(table.area[0]) == 0.0
    np.testing.assert_allclose(table.position, where[8:], atol=1e-12)


def test_contacts_at_the_edge_count_for_the_shift_of_a_design():
    few, full, _, closed = cropped()
    edge = replace(few, edge=np.isin(closed, [39, 63]))
    table = track_contacts([edge, full], ["a", "b"], sites=DesignSites(SITES)).table
    assert np.flatnonzero(table.area[0] > 0.0).tolist() == sorted(set(closed) - {39, 63})
    assert np.flatnonzero(np.isnan(table.area[0])).tolist() == [39, 63]


@pytest.mark.parametrize("given", [{}, {"sites": DesignSites(SITES)}])
def test_a_shift_by_one_pitch_that_matches_two_contacts_more_is_not_taken(given):
    """Two of eight contacts stand beyond the upper row."""
    where = seen(SITES)
    few = contacts(np.vstack([where[[56, 57]] + [0.0, 1.5], where[10:16]]), 0.1, shape=(1600, 1600))
    tracked = track_contacts([few, contacts(where, 0.2, shape=(1600, 1600))], ["a", "b"], **given)
    assert np.flatnonzero(tracked.table.area[0] > 0.0).tolist() == list(range(10, 16))
    assert [str(note) for note in tracked.notes if "shifted" in str(note)] == [
        "a: contacts may be shifted by one lattice distance; "
        + ("compare the numbers in its picture" if given else "give --sites")
    ]


@pytest.mark.parametrize(("drift", "unclear"), [(0.5, False), (0.7, True)])
def test_a_shift_by_nearly_half_a_pitch_is_not_certain_for_few_contacts(drift, unclear):
    where = seen(SITES)
    few = contacts(where[[18, 27, 29, 37]] + [drift, 0.0], 0.1)
    tracked = track_contacts([few, contacts(where, 0.2)], ["a", "b"], sites=DesignSites(SITES))
    assert np.flatnonzero(tracked.table.area[0] > 0.0).tolist() == [18, 27, 29, 37]
    assert any("may be shifted" in str(note) for note in tracked.notes) == unclear
    all_of_them = contacts(where + np.array([drift, 0.0]), 0.1, shape=(1400, 1500))
    tracked = track_contacts([all_of_them, contacts(where, 0.2)], ["a", "b"], sites=DesignSites(SITES))
    assert not any("may be shifted" in str(note) for note in tracked.notes)


def test_what_cannot_be_measured_is_named():
    where = seen(SITES)
    last = contacts(where, 0.3)
    # at the edge, merged with its neighbour to the right, saturated, and a region between the sites
    centre = np.vstack([where[:61], [0.5 * (where[61] + where[62])], where[63:], [where[9] + 0.7]])
    flags = {"edge": [0], "merged": [61]}
    saturated = np.arange(64) == 20
    second = contacts(centre, 0.3, saturated=saturated, **flags)
    axes = second.axes.copy()
    axes[61] = [0.9, 0.3]
    second = replace(second, axes=axes)
    third = contacts(where[:0], 0.3, failed=True, notes=(Note("cannot be read: truncated"),))
    fourth = contacts(where[where[:, 1] < 12.0], 0.3, shape=(1200, 1400))
    found = track_contacts([last, second, third, fourth], list("abcd"), sites=DesignSites(SITES)).table
    assert found.remarks == (
        "b: 1 region belongs to no site; the largest has 0.283 mm² at (2.95, 3.95) mm",
        "b, site 0: at the edge of the frame",
        "b, site 20: saturated grey levels, the area may be wrong",
        "b, site 61: merged with site 62",
        "b, site 62: merged with site 61",
        "c: cannot be read: truncated",
        "d: sites 56, 57, 58, 59, 60, 61, 62, 63 outside the frame",
    )
    assert np.flatnonzero(np.isnan(found.area[1])).tolist() == [0, 61, 62]
    assert np.isnan(found.area[2]).all()
    assert np.flatnonzero(np.isnan(found.area[3])).tolist() == list(range(56, 64))


def test_a_region_beside_its_site_is_not_open():
    centre = seen(SITES)
    centre[5] += 0.15
    table = track_contacts(
        [contacts(seen(SITES), 0.2), contacts(centre, 0.3)], ["a", "b"], sites=DesignSites(SITES)
    )
    assert np.flatnonzero(np.isnan(table.table.area[1])).tolist() == [5]
    assert table.table.remarks == (
        "b, site 5: its region is not centred on the site, as if merged with another",
    )


def test_an_image_of_another_lattice_is_named():
    other = contacts(seen(lattice(pitch=1.1)), 0.2)
    with pytest.raises(InvalidInput, match=r"b\.tif: the 64 contacts are not on the sites"):
        track_contacts([contacts([[1.0, 1.0]], 0.1), other], ["a.tif", "b.tif"], sites=DesignSites(SITES))


def test_dust_in_the_fullest_image_leaves_the_others():
    rng = np.random.default_rng(0)
    dusty = contacts(np.vstack([seen(SITES), rng.random((80, 2)) * 13.0]), 0.1)
    tracked = track_contacts([contacts(seen(SITES), 0.2), dusty], ["a", "b"], sites=DesignSites(SITES))
    assert tracked.reference == 0


def test_expected_areas_decide_by_the_load_of_the_image():
    expected = np.random.default_rng(3).uniform(0.02, 0.1, (2, 64))
    expected[0, :] = np.nan
    expected[1, 56:] = 0.0
    closed = contacts(seen(SITES[:56]), np.sqrt(expected[1, :56] / np.pi), shape=(1400, 1200))
    few = contacts(seen(SITES[:5]), 0.1, shape=(1400, 1200))
    given = {"areas": [few, closed], "image": ["a", "b"], "sites": DesignSites(SITES)}
    assert track_contacts(**given).table.remarks[0].startswith("b: the 56 contacts match the sites equally")
    tracked = track_contacts(**(given | {"sites": DesignSites(SITES, expected_area=expected)}))
    assert tracked.match.site.tolist() == list(range(56))
    assert [note.warns for note in tracked.notes] == [False]


@pytest.mark.parametrize(("given_", "message"), [
    ({"areas": []}, "image holds 1 entries; areas holds 0"),
    ({"areas": [], "image": []}, "no contact can be measured in an empty list"),
    ({"areas": [contacts(np.zeros((0, 2)), 0.1)]}, "no contact can be measured in a"),
    ({"areas": [1]}, "areas = 1 must be ContactAreas"),
    ({"areas": [contacts(SITES, 0.1)] * 2, "image": ["a", "a"]}, "image holds a twice"),
    ({"load": [1.0, 2.0]}, "load has 2 numbers; it must have 1"),
    ({"load": [np.inf]}, "load holds inf at entry 0"),
    ({"test": []}, "test holds 0 entries"),
    ({"sites": DesignSites(SITES, expected_area=np.ones(64))}, r"it must have shape \(1, 64\)"),
])  # fmt: skip
def test_bad_input(given_, message):
    with pytest.raises(InvalidInput, match=message):
        track_contacts(**{"areas": [contacts(seen(SITES), 0.1)], "image": ["a"], **given_})


def test_sites_have_numbers_of_their_own():
    with pytest.raises(InvalidInput, match="site must hold 64 different numbers"):
        DesignSites(SITES, [1] * 64)
