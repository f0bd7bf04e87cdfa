"""Contacts that are matched to sites and followed in difficult images."""

from dataclasses import replace

import numpy as np
import pytest

from metafem.calibration import DesignSites, match_sites, track_contacts
from metafem.calibration.sites.search import Pose, complex_points, fitted, real_points
from metafem.errors import InvalidInput
from tests.calibration.sites.scenes import SITES, contacts, cropped, loading
from validation.scenes.lattice_views import lattice, seen, trial


# The claim of the validation on site matching has the first 250 trials with eight rows.
@pytest.mark.parametrize(("rows", "seeds"), [(8, range(250, 330)), (7, range(80))])
def test_many_random_trials(rows, seeds):
    for seed in seeds:
        centre, site = trial(seed, contacts=45 if rows == 8 else 39, rows=rows)
        found = match_sites(centre, SITES)
        if rows == 8:
            assert found.site.tolist() == site.tolist()
        else:
            assert found.ambiguous
            rows_off = (found.site - site)[site >= 0]
            assert len(set(rows_off.tolist())) == 1
            assert rows_off[0] in (0, 8)


def test_through_the_block_heights_csv_is_mirrored():
    """Three asperities of an L: two along +x, one along +y."""
    sites = np.array([[0.0, 0.0], [1.5, 0.0], [3.0, 0.0], [0.0, 1.5]])
    above = match_sites(sites, sites, viewed_from="glass")
    assert above.site.tolist() == [0, 1, 2, 3]
    below = match_sites([[0.0, 0.0], [-1.5, 0.0], [-3.0, 0.0], [0.0, 1.5]], sites, viewed_from="block")
    assert below.site.tolist() == [0, 1, 2, 3]
    assert below.rotation == pytest.approx(0.0, abs=1e-15)
    wrong = match_sites(sites, sites, viewed_from="block")
    assert -1 in wrong.site  # the three in a row alone look the same from both sides


def test_without_areas_the_design_is_centred():
    centre = seen(SITES[:56])
    assert match_sites(centre, SITES, frame=(12.0, 14.5)).site.tolist() == list(range(56))
    assert match_sites(centre, SITES, frame=(12.0, 11.5)).site.tolist() == list(range(8, 64))


@pytest.mark.parametrize(("shape", "pitch"), [((5, 5), 1.0), ((8, 8), 0.75), ((8, 8), 3.0), ((12, 12), 1.5)])
def test_another_lattice_is_refused(shape, pitch):
    centre = seen(lattice(shape, pitch), turn=0.02)
    with pytest.raises(InvalidInput, match=rf"{len(centre)} contacts .* {pitch:.3g} mm .* 1.5 mm"):
        match_sites(centre, SITES)


def test_an_image_without_load_does_not_number_the_contacts():
    other = contacts(np.random.default_rng(0).uniform(0.5, 13.5, (90, 2)), 0.2)
    own = contacts(seen(SITES), 0.3)
    assert track_contacts([other, own], ["a", "b"], load=[np.nan, 1.0]).reference == 1
    assert track_contacts([other, own], ["a", "b"]).reference == 0


def test_a_shift_by_more_than_half_a_pitch_is_found_where_the_whole_lattice_is_seen():
    found, exact = loading(drift=0.0)
    moved = [replace(one, centre=one.centre + np.array([1.0, 0.0]), shape=(1400, 1600)) for one in found]
    table = track_contacts([*found, moved[-1]], list("abcdefg"), sites=DesignSites(SITES)).table
    np.testing.assert_allclose(table.area[-1], exact[-1], rtol=1e-12)


@pytest.mark.parametrize("given", [{}, {"sites": DesignSites(SITES)}])
def test_a_shift_by_one_pitch_that_matches_two_contacts_more_is_not_taken(given):
    """Two of eight contacts stand beyond the upper row."""
    where = seen(SITES)
    few = contacts(np.vstack([where[[56, 57]] + [0.0, 1.5], where[10:16]]), 0.1, shape=(1600, 1600))
    tracked = track_contacts([few, contacts(where, 0.2, shape=(1600, 1600))], ["a", "b"], **given)
    assert np.flatnonzero(tracked.table.area[0] > 0.0).tolist() == list(range(10, 16))
    assert sum("may be shifted" in str(note) for note in tracked.notes) == 1


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


def test_the_fit_of_a_pose_has_the_least_squares():
    """Any small change of the fitted numbers raises the sum of squares."""
    rng = np.random.default_rng(0)
    points, sites = rng.normal(size=(2, 8)) + 1j * rng.normal(size=(2, 8))
    found = fitted(points, sites)

    def squares(factor, shift):
        return np.sum(np.abs(points - Pose(factor, shift).image(sites)) ** 2)

    least = squares(found.factor, found.shift)
    for step in (1e-3, -1e-3, 1e-3j, -1e-3j):
        assert squares(found.factor + step, found.shift) > least
        assert squares(found.factor, found.shift + step) > least
    plane = np.array([[1.0, 2.0], [-3.0, 0.5]])
    np.testing.assert_array_equal(real_points(complex_points(plane, mirrored=True)), plane * [-1.0, 1.0])


def test_contacts_cut_by_the_frame_at_large_load_do_not_shift_the_others():
    few, full, where, closed = cropped()
    table = track_contacts([few, full], ["a", "b"]).table
    assert len(table.site) == 64
    near = np.array([np.argmin(np.hypot(*(where - p).T)) for p in table.position])
    measured = table.area[0] > 0.0
    assert near[measured].tolist() == sorted(closed)
    np.testing.assert_allclose(table.area[0, measured], few.area[np.argsort(closed)], rtol=1e-12)
    assert near[np.isnan(table.area[1])].tolist() == [39, 63]
    alone = track_contacts([full], ["b"]).table
    assert len(alone.site) == 62
    assert "2 regions" in alone.remarks[0]
    assert "0.251 mm²" in alone.remarks[0]
