"""Areas of contacts in images that are difficult, and images that are read one by one."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import contact_areas, stack_areas
from metafem.calibration.images import errors
from metafem.calibration.images.boundary import contours
from metafem.calibration.images.levels import smoothed
from tests.calibration.images.scenes import PIXEL, images
from validation.scenes.pictures import BRIGHT, DARK, coverage, lattice, picture


def test_different_dark_levels_enter_the_errors():
    rng = np.random.default_rng(0)
    shape, centre = lattice(5, 20.0, rng)
    scatters = []
    for scatter in (0.0, 0.02):
        # the pitch of the lattice is the same for all
        dark = np.kron(scatter * rng.standard_normal((5, 5)), np.ones((shape[0] // 5, shape[0] // 5)))
        covered = coverage(shape, centre, np.full(25, 20.0))
        image = BRIGHT + (DARK + dark - BRIGHT) * covered + 0.002 * rng.standard_normal(shape)
        found = contact_areas(image, 1.0)
        error = found.area - np.pi * 400.0
        scatters.append(error.std())
        assert found.area_error.mean() == pytest.approx(error.std(), rel=0.4)
    assert scatters[1] > 5.0 * scatters[0]


def test_otsus_threshold_is_kept_where_it_works():
    from skimage.filters import threshold_otsu

    for noise, share in ((0.02, 1.0), (0.1, 0.3)):
        shape = tuple(round(share * n) for n in (420, 420))
        image = picture(
            shape, share * np.array([(90.3, 100.0), (310.0, 300.4)]), np.array([6.5, 8.0]), noise=noise
        )
        found = contact_areas(image, 1.0)
        assert not found.notes
        assert found.threshold == pytest.approx(threshold_otsu(image / BRIGHT), abs=0.02)


def test_contacts_that_touch_are_named_as_merged():
    for other, gap in ((9.0, -2.0), (15.0, 0.0), (30.0, 2.0), (30.0, 6.0)):
        radius = np.array([30.0, other])
        centre = [(60.0, 60.0), (90.0 + other + gap, 60.0)]
        found = contact_areas(picture((120, 180), centre, radius, noise=0.03), PIXEL)
        if gap > 4.0:
            assert found.complete.tolist() == [True, True]
        else:
            assert found.merged.tolist() == [True]
            assert found.area[0] == pytest.approx(np.pi * (radius**2).sum() * PIXEL**2, rel=0.01)


def test_contacts_without_a_dark_middle_or_at_the_edge_alone_are_named():
    shape, centre = lattice(4, 6.0, np.random.default_rng(0))
    image = picture(shape, centre, np.full(16, 6.0), blur=2.5)
    assert "wide enough" in str(contact_areas(image, 1.0, smallest_area=0.0).notes[0])
    # with the levels of an image of wide contacts the areas are right but for the third order
    known = contact_areas(image, 1.0, smallest_area=0.0, threshold=0.6, dark_level=DARK / BRIGHT, blur=2.517)
    assert not known.notes
    assert known.area == pytest.approx(36.0 * np.pi, rel=0.01)
    found = contact_areas(picture((60, 60), [(0.0, 30.0)], [20.0]), 1.0)
    assert found.edge.all()
    assert "give blur" in str(found.notes[0])


def test_images_are_read_one_by_one_and_progress_is_reported():
    read, steps = [], []

    class Lazy:
        def __len__(self):
            return 4

        def __getitem__(self, i):
            read.append(i)
            return images()[i]

    with mf.progress.listening(lambda step, done: steps.append(step)):
        stack_areas(Lazy(), PIXEL, loads=[0.1, 0.2, 0.4, 0.3])
    assert read == [2, 3, 1, 0]
    assert steps == [f"measuring image {i} of 4" for i in (1, 2, 3, 4)]


def test_the_area_lost_by_interpolation_does_not_depend_on_radius_and_blur():
    lost = []
    for radius, blur in ((20.0, 2.0), (45.0, 1.5)):
        side = int(2.0 * radius + 40.0)
        centres = side / 2.0 + np.random.default_rng(1).uniform(-0.5, 0.5, (8, 2))
        for centre in centres:
            covered = coverage((side, side), [centre], [radius], blur=blur)
            image, variance = smoothed((1.0 - covered).astype(np.float32), blur)
            found = contours(image, (image < 0.5).astype(np.int32), 0.5, 1)
            total = np.sqrt(blur**2 + 1.0 / 12.0 + variance)
            lost.append(np.pi * radius**2 - errors.enclosed(found.area, 0.0, total)[0])
    # pi times 0.03 square pixels: the spread of the constant
    assert np.abs(np.reshape(lost, (2, 8)).mean(axis=1)).max() < np.pi * 0.03
