"""Contacts are matched to the sites of a design and followed through the images of a test."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem.calibration import match_sites, track_contacts
from metafem.calibration.contact_table import by_image
from tests.calibration.sites.scenes import SITES, contacts, cropped, loading
from validation.scenes.lattice_views import seen, trial


def test_all_contacts_of_a_lattice_with_open_ones():
    for seed, spurious, side in ((0, 0, "glass"), (1, 4, "block"), (2, 4, "glass")):
        centre, site = trial(seed, spurious=spurious, mirrored=side == "block")
        found = match_sites(centre, SITES, viewed_from=side)
        assert found.site.tolist() == site.tolist()
        assert found.mirrored is (side == "block")
        # the root mean square of a normal error of 5 µm along x and along y, with 4 of 90 fitted
        assert found.residual == pytest.approx(0.005 * np.sqrt(2.0), rel=0.35)


@settings(max_examples=10)
@given(st.integers(12, 40), st.floats(-4.9, 4.9), st.floats(0.91, 1.09), st.booleans(), st.integers(0, 1000))
def test_any_arrangement(n, turn, scale, mirrored, seed):
    rng = np.random.default_rng(seed)
    sites = rng.random((n, 2)) * 10.0
    turn = np.radians(turn)
    centre = seen(sites, turn=turn, scale=scale, mirrored=mirrored)
    kept = rng.permutation(n)[: n - n // 4]
    found = match_sites(centre[kept], sites, viewed_from="block" if mirrored else "glass")
    assert found.site.tolist() == kept.tolist()
    assert not found.ambiguous
    # rounding of coordinates of 10 mm, over the extent of the arrangement
    assert found.rotation == pytest.approx(turn, abs=1e-13)
    assert found.scale == pytest.approx(scale, rel=1e-13)
    np.testing.assert_allclose(found.to_image(sites), centre, atol=1e-12)


def test_an_open_outer_row_is_ambiguous():
    found = match_sites(seen(SITES[:56], turn=0.03, scale=1.02), SITES)
    assert found.ambiguous


def tracked(found, load=np.nan, sheared=(), **given):
    """Follow contacts in images a, b, c and so on, and under shear in A, B, C; return also the areas."""
    names = [chr(97 + i) for i in range(len(found))]
    under = {chr(65 + i): one for i, one in enumerate(sheared) if one is not None}
    forces = pd.DataFrame({"image": names, "test": "1", "load": load, "friction_force": np.nan})
    forces["sheared_image"] = [name.upper() if name.upper() in under else "" for name in names]
    found = track_contacts(dict(zip(names, found, strict=True)) | under, forces, **given)
    result = SimpleNamespace(**dict(zip(("table", "name", "match", "notes"), found, strict=True)))
    return result, by_image(result.table)[1]


def test_areas_stand_at_their_sites_in_all_images():
    found, exact = loading(mirrored=True)
    result, areas = tracked(found, 0.1 * np.arange(6), site_position=SITES, viewed_from="block")
    np.testing.assert_allclose(areas["area"], exact, rtol=1e-12)
    np.testing.assert_allclose(areas["area_error"], 0.01 * exact, rtol=1e-12)
    assert result.name == "f"
    assert result.table["site"].tolist() == [*range(64)] * 6
    assert result.notes == []
    assert np.isnan(areas["sheared_area"]).all()
    np.testing.assert_array_equal(result.table[["x", "y"]][:64], SITES)
    few = np.arange(3, 64, 2)
    own = contacts(seen(SITES[few])[::-1], 0.1 + 0.001 * few[::-1])
    result, areas = tracked([own], site_position=SITES[few], site_number=few)
    assert result.table["site"].tolist() == few.tolist()
    np.testing.assert_allclose(areas["area"][0], np.pi * (0.1 + 0.001 * few) ** 2, rtol=1e-12)


def test_without_sites_contacts_are_numbered_and_followed():
    """Five caps 7.1 mm apart, in the order in which the fullest image shows them."""
    caps = 2.0 + 7.1 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]])
    rng = np.random.default_rng(1)
    shifts = rng.uniform(-0.5, 0.5, (4, 2))
    shifts[-1] = 0.0
    closed = [[2], [2, 4], [4, 2, 0, 1], [0, 1, 2, 3, 4]]
    found = [contacts(caps[c] + d, 0.1 + 0.01 * np.array(c)) for c, d in zip(closed, shifts, strict=True)]
    result, areas = tracked(found)
    exact = np.zeros((4, 5))
    for i, c in enumerate(closed):
        exact[i, c] = np.pi * (0.1 + 0.01 * np.array(c)) ** 2
    np.testing.assert_allclose(areas["area"], exact, rtol=1e-12)
    np.testing.assert_allclose(result.table[["x", "y"]][:5], caps, atol=1e-12)
    assert result.table["site"].isna().all()
    assert result.match is None
    assert result.table["contact"].tolist() == [1, 2, 3, 4, 5] * 4


def test_sheared_images_move_with_their_contacts():
    found, exact = loading(drift=0.05)
    moved = [
        None if i % 2 else replace(each, centre=each.centre + np.array([0.4, 0.1]), area=0.85 * each.area)
        for i, each in enumerate(found)
    ]
    _, areas = tracked(found, sheared=moved, site_position=SITES)
    np.testing.assert_allclose(areas["sheared_area"][::2], 0.85 * exact[::2], rtol=1e-12)
    assert np.isnan(areas["sheared_area"][1::2]).all()


def test_what_cannot_be_measured_has_no_area():
    where = seen(SITES)
    # at the edge, merged with its neighbour to the right, and a region between the sites
    centre = np.vstack([where[:61], [0.5 * (where[61] + where[62])], where[63:], [where[9] + 0.7]])
    second = contacts(centre, 0.3, edge=[0], merged=[61])
    axes = second.axes.copy()
    axes[61] = [0.9, 0.3]
    second = replace(second, axes=axes)
    fourth = contacts(where[where[:, 1] < 12.0], 0.3, shape=(1200, 1400))
    beside = where.copy()
    beside[5] += 0.22
    result, areas = tracked(
        [contacts(where, 0.3), second, None, fourth, contacts(beside, 0.35)], site_position=SITES
    )
    assert [np.flatnonzero(np.isnan(area)).tolist() for area in areas["area"]] == [
        *([], [0, 61, 62], list(range(64)), list(range(56, 64)), [5]),
    ]
    assert [note.text[:22] for note in result.notes] == ["b: 1 regions are on no", "e: 1 regions are on no"]


def test_through_the_block_heights_csv_is_mirrored():
    """Four asperities of an L: three along +x, one along +y."""
    sites = np.array([[0.0, 0.0], [1.5, 0.0], [3.0, 0.0], [0.0, 1.5]])
    for side, sign in (("glass", 1.0), ("block", -1.0)):
        found = match_sites(sites * [sign, 1.0], sites, viewed_from=side)
        assert found.site.tolist() == [0, 1, 2, 3]
        assert found.rotation == pytest.approx(0.0, abs=1e-15)
    # the three in a row alone look the same from both sides
    assert -1 in match_sites(sites, sites, viewed_from="block").site


def test_an_image_without_load_does_not_number_the_contacts():
    other = contacts(np.random.default_rng(0).uniform(0.5, 13.5, (90, 2)), 0.2)
    own = contacts(seen(SITES), 0.3)
    assert tracked([other, own], [np.nan, 1.0])[0].name == "b"
    assert tracked([other, own])[0].name == "a"


def test_a_shift_by_more_than_half_a_pitch_leaves_contacts_on_no_site_and_is_said():
    where = seen(SITES)
    for drift, strays in ((0.7, 0), (1.0, 8)):
        moved = contacts(where + np.array([drift, 0.0]), 0.1, shape=(1400, 1500))
        result, _ = tracked([moved, contacts(where, 0.2)], [0.0, 1.0], site_position=SITES)
        assert len(result.notes) == (strays > 0)
        assert not strays or f"{strays} regions are on no site" in str(result.notes[0])


def test_contacts_cut_by_the_frame_at_large_load_do_not_shift_the_others():
    few, full, where, closed = cropped()
    result, areas = tracked([few, full])
    table = result.table[:64]
    assert len(result.table) == 2 * 64
    near = np.array([np.argmin(np.hypot(*(where - p).T)) for p in table[["x", "y"]].to_numpy()])
    measured = areas["area"][0] > 0.0
    assert near[measured].tolist() == sorted(closed)
    np.testing.assert_allclose(areas["area"][0, measured], few.area[np.argsort(closed)], rtol=1e-12)
    assert near[np.isnan(areas["area"][1])].tolist() == [39, 63]
    assert len(tracked([full])[0].table) == 62
