"""Dark level and blur of synthetic images, from wide contacts and from narrow ones."""

import numpy as np
import pytest

from metafem.calibration import contact_areas
from metafem.notes import Level
from validation.scenes.pictures import BRIGHT, DARK, coverage, lattice, picture

# a large frame with two small contacts
SPARSE, CENTRES, RADII = (420, 420), [(90.3, 100.0), (310.0, 300.4)], np.array([6.5, 8.0])


@pytest.mark.parametrize("radius", [8.0, pytest.param(15.0, marks=pytest.mark.slow), 40.0])
@pytest.mark.parametrize("blur", [0.5, 2.0])
def test_dark_level_and_blur_are_those_of_the_picture(radius, blur):
    rng = np.random.default_rng(int(radius))
    shape, centre = lattice(3, radius, rng)
    found = contact_areas(picture(shape, centre, np.full(9, radius), blur=blur, noise=0.02, rng=rng), 1.0)
    assert found.dark_level == pytest.approx(DARK / BRIGHT, abs=0.01)
    assert found.blur == pytest.approx(np.sqrt(blur**2 + 1.0 / 12.0), abs=0.06)


def test_contacts_without_a_dark_middle_are_named():
    shape, centre = lattice(4, 6.0, np.random.default_rng(0))
    image = picture(shape, centre, np.full(16, 6.0), blur=2.5)
    narrow = contact_areas(image, 1.0, smallest_area=0.0)
    assert "no contact is wide enough" in str(narrow.notes[0])
    # with the levels of an image of wide contacts the areas are right but for the third order
    known = contact_areas(image, 1.0, smallest_area=0.0, threshold=0.6, dark_level=DARK / BRIGHT, blur=2.517)
    assert not known.notes
    assert known.area == pytest.approx(36.0 * np.pi, rel=0.01)


def test_contacts_at_the_edge_alone_do_not_show_their_blur():
    image = picture((60, 60), [(0.0, 30.0)], [20.0])
    found = contact_areas(image, 1.0)
    assert found.edge.all()
    assert "give blur" in str(found.notes[0])


def test_different_dark_levels_enter_the_errors():
    rng = np.random.default_rng(0)
    shape, centre = lattice(5, 20.0, rng)
    errors = []
    for scatter in (0.0, 0.02):
        # the pitch of the lattice is the same for all
        dark = np.kron(scatter * rng.standard_normal((5, 5)), np.ones((shape[0] // 5, shape[0] // 5)))
        covered = coverage(shape, centre, np.full(25, 20.0))
        image = BRIGHT + (DARK + dark - BRIGHT) * covered + 0.002 * rng.standard_normal(shape)
        found = contact_areas(image, 1.0)
        error = found.area - np.pi * 400.0
        errors.append(error.std())
        assert found.area_error.mean() == pytest.approx(error.std(), rel=0.4)
    assert errors[1] > 5.0 * errors[0]


@pytest.mark.parametrize("bad_pixel", [False, True])
def test_contacts_that_cover_a_thousandth_of_the_image(bad_pixel):
    # the threshold of Otsu lies in the noise of the ground here
    image = picture(SPARSE, CENTRES, RADII, noise=0.1, gradient=(0.15, -0.1), bits=8)
    if bad_pixel:
        image[200, 50] = 0
    found = contact_areas(image, 1.0)
    exact = np.pi * RADII[::-1] ** 2
    assert np.abs(found.area / exact - 1.0).max() < 4.0 * (found.area_error / exact).max() < 0.1
    assert np.abs(found.otsu_area / exact - 1.0).max() < 0.1
    assert found.dark_level == pytest.approx(DARK / BRIGHT, abs=0.02)
    assert [note.level for note in found.notes] == [Level.INFORMATION]
    assert "too little of the image for Otsu's method" in str(found.notes[0])


def test_otsus_threshold_is_kept_where_it_works():
    from skimage.filters import threshold_otsu

    for noise, share in ((0.02, 1.0), (0.1, 0.3)):
        shape = tuple(round(share * n) for n in SPARSE)
        image = picture(shape, share * np.array(CENTRES), RADII, noise=noise)
        found = contact_areas(image, 1.0)
        assert not found.notes
        assert found.threshold == pytest.approx(threshold_otsu(image / BRIGHT), abs=0.02)
