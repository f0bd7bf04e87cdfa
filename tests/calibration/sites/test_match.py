import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem.calibration import match_sites
from metafem.errors import InvalidInput
from validation.scenes.lattice_views import lattice, seen, trial

SITES = lattice()


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("spurious", [0, 4])
def test_all_contacts_of_a_lattice_with_open_ones(mirrored, spurious):
    side = "block" if mirrored else "glass"
    for seed in range(4):
        centre, site = trial(seed, spurious=spurious, mirrored=mirrored)
        found = match_sites(centre, SITES, viewed_from=side)
        assert found.site.tolist() == site.tolist()
        assert found.mirrored is mirrored
        # the root mean square of a normal error of 5 µm along x and along y, with 4 of 90 fitted
        assert found.residual == pytest.approx(0.005 * np.sqrt(2.0), rel=0.35)


# The claim of the validation on site matching has the first 250 trials with eight rows.
@pytest.mark.slow
@pytest.mark.parametrize(("rows", "seeds"), [(8, range(250, 400)), (7, range(150))])
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


@settings(max_examples=10, deadline=None)
@given(
    n=st.integers(12, 40),
    turn=st.floats(-4.9, 4.9),
    scale=st.floats(0.91, 1.09),
    mirrored=st.booleans(),
    seed=st.integers(0, 1000),
)
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
    np.testing.assert_allclose(found.to_design(centre), sites, atol=1e-12)


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


def test_an_open_outer_row_is_ambiguous_unless_areas_decide():
    expected = np.random.default_rng(3).uniform(0.02, 0.1, 64)
    expected[56:] = 0.0
    centre = seen(SITES[:56], turn=0.03, scale=1.02)
    blind = match_sites(centre, SITES)
    assert blind.ambiguous
    assert "equally well in 2 places" in str(blind.notes[0])
    area = 1.3 * expected[:56] * np.random.default_rng(4).normal(1.0, 0.1, 56)
    found = match_sites(centre, SITES, area=area, expected_area=expected)
    assert not found.ambiguous
    assert found.site.tolist() == list(range(56))
    same = match_sites(centre, SITES, area=np.ones(56), expected_area=np.ones(64))
    assert same.ambiguous
    # a frame that ends above the last row: its sites are not open, they are not seen
    upper = match_sites(
        centre, SITES, area=np.ones(56), expected_area=np.ones(64), frame=centre.max(axis=0) + 0.1
    )
    assert not upper.ambiguous
    assert upper.site.tolist() == list(range(56))


def test_without_areas_the_design_is_centred():
    centre = seen(SITES[:56])
    assert match_sites(centre, SITES, frame=(12.0, 14.5)).site.tolist() == list(range(56))
    assert match_sites(centre, SITES, frame=(12.0, 11.5)).site.tolist() == list(range(8, 64))


@pytest.mark.parametrize(("quarters", "mirrored", "words"), [
    (0, True, "seen through the block"),
    (2, False, "turned by 180°"),
    (1, False, "turned by 90°"),
])  # fmt: skip
def test_areas_tell_another_view(quarters, mirrored, words):
    expected = np.random.default_rng(3).uniform(0.02, 0.1, 64)
    centre = seen(SITES, turn=0.02 + 0.5 * np.pi * quarters, mirrored=mirrored)
    area = expected * np.random.default_rng(4).normal(1.0, 0.1, 64)
    (note,) = match_sites(centre, SITES, area=area, expected_area=expected).notes
    assert note.warns
    assert words in str(note)
    side = "block" if mirrored else "glass"
    right = match_sites(
        centre, SITES, viewed_from=side, rotation=0.5 * np.pi * quarters, area=area, expected_area=expected
    )
    assert right.site.tolist() == list(range(64))
    assert right.notes == ()


@pytest.mark.parametrize(("shape", "pitch"), [
    ((8, 8), 1.0), ((5, 5), 1.0), ((8, 8), 0.75), ((8, 8), 1.2), ((8, 8), 2.0), ((8, 8), 3.0),
    ((12, 12), 1.5),
])  # fmt: skip
def test_another_lattice_is_refused(shape, pitch):
    centre = seen(lattice(shape, pitch), turn=0.02)
    with pytest.raises(InvalidInput) as caught:
        match_sites(centre, SITES)
    text = str(caught.value)
    assert f"the {len(centre)} contacts are not on the sites of the design" in text
    assert f"{pitch:.3g} mm apart in the image and 1.5 mm in the design" in text
    assert ("times as large" in text) == (pitch != 1.5)


def test_scattered_regions_are_refused():
    rng = np.random.default_rng(0)
    for _ in range(5):
        with pytest.raises(InvalidInput, match="not on the sites"):
            match_sites(rng.random((50, 2)) * 11.0, SITES)


@pytest.mark.parametrize(("given_", "message"), [
    ({"centre": SITES[:2]}, "2 contacts cannot be matched"),
    ({"site_position": SITES[:2]}, "2 sites cannot be matched"),
    ({"viewed_from": "below"}, "viewed_from = 'below' must be 'glass'"),
    ({"expected_area": np.ones(64)}, "expected_area needs area"),
    ({"area": np.ones(3), "expected_area": np.ones(64)}, "area has 3 numbers"),
    ({"site_position": np.zeros((4, 2))}, "coincident sites"),
    ({"rotation_range": 0.0}, "rotation_range = 0 must be greater than 0"),
    ({"centre": [[0.0, np.nan]] * 4}, "centre holds nan"),
])  # fmt: skip
def test_bad_input(given_, message):
    with pytest.raises(InvalidInput, match=message):
        match_sites(**{"centre": SITES, "site_position": SITES, **given_})
