"""Areas of contacts in synthetic images against the exact areas of the ellipses that are drawn."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import contact_areas, stack_areas
from metafem.calibration.images import without_illumination
from tests.calibration.images.scenes import CENTRE, PIXEL, RADII, SHAPE, centres, images, in_order
from validation.scenes.pictures import BRIGHT, DARK, coverage, illumination, lattice, picture


def test_sheared_contacts_are_ellipses():
    shape, centre = centres(4, 90, np.random.default_rng(4))
    rng = np.random.default_rng(5)
    axes = np.sort(rng.uniform(12.0, 30.0, (16, 2)))[:, ::-1]
    angle = rng.uniform(-1.5, 1.5, 16)
    found = contact_areas(picture(shape, centre, axes, angle, gradient=(0.3, -0.2), vignetting=0.1), PIXEL)
    which = in_order(found, centre)
    assert found.area[which] == pytest.approx(np.pi * axes.prod(axis=1) * PIXEL**2, rel=1e-3)
    assert found.centre[which] == pytest.approx(centre * PIXEL, abs=0.15 * PIXEL)
    assert found.axes[which] == pytest.approx(axes * PIXEL, rel=0.03)
    turned = (found.angle[which] - angle + 0.5 * np.pi) % np.pi - 0.5 * np.pi
    assert np.abs(turned * (1.0 - axes[:, 1] / axes[:, 0])).max() < 5e-3
    assert found.complete.all()
    assert not found.notes


def test_without_noise_the_correction_leaves_no_bias():
    for radius, blur in ((12.0, 1.5), (25.0, 0.8)):
        shape, centre = centres(3, int(4 * radius), np.random.default_rng(3))
        found = contact_areas(picture(shape, centre, np.full(9, radius), blur=blur), PIXEL)
        error = found.area / (np.pi * (radius * PIXEL) ** 2) - 1.0
        # 0.21 square pixels are left of the third order of the curvature, and of the steps between pixels
        assert np.abs(error).max() < 0.21 / (np.pi * radius**2) + 2e-5
        # a pixel adds the variance 1/12 of its square
        assert found.blur / PIXEL == pytest.approx(np.sqrt(blur**2 + 1.0 / 12.0), abs=0.02)


def test_reported_errors_are_the_scatter():
    radius, noise, rng = 15.0, 0.02, np.random.default_rng(6)
    shape, centre = centres(10, 60, rng)
    found = contact_areas(picture(shape, centre, np.full(100, radius), noise=noise, rng=rng), PIXEL)
    error = found.area - np.pi * (radius * PIXEL) ** 2
    assert np.sqrt(np.mean((error / found.area_error) ** 2)) == pytest.approx(1.0, abs=0.2)
    # the Cramer-Rao bound of a straight edge as long as the perimeter
    s = np.hypot(1.5, np.sqrt(1.0 / 12.0))
    bound = noise * np.sqrt(2.0 * np.sqrt(np.pi) * s * 2.0 * np.pi * radius) * PIXEL**2
    assert error.std() == pytest.approx(bound, rel=0.2)


def test_flags_name_contacts_at_the_edge_and_merged():
    centre = [(60.0, 60.0), (96.0, 60.0), (100.0, 140.0), (190.0, 80.0), (30.0, 150.0)]
    covered = coverage((200, 200), centre, [18.0, 18.0, 20.0, 25.0, 12.0])
    covered -= coverage((200, 200), [(100.0, 140.0)], [6.0])
    covered += coverage((200, 200), [(180.0, 180.0)], [3.5])
    found = contact_areas(0.7 - 0.5 * np.minimum(covered, 1.0), PIXEL)
    assert found.count == 4
    (merged,) = np.flatnonzero(found.merged)
    assert found.centre[merged] / PIXEL == pytest.approx((78.0, 60.0), abs=0.5)
    (edge,) = np.flatnonzero(found.edge)
    assert found.centre[edge, 0] / PIXEL > 175.0
    assert found.area[1] == pytest.approx(np.pi * (20.0**2 - 6.0**2) * PIXEL**2, rel=1e-3)


def test_areas_do_not_depend_on_scale_direction_and_sign():
    for change, bright in (
        (lambda i: 3.0 * i, False),
        (lambda i: i[::-1].T, False),
        (lambda i: 0.9 - i, True),
    ):
        shape, centre = centres(2, 80, np.random.default_rng(1))
        image = picture(shape, centre, [12.0, 15.0, 20.0, 25.0], noise=0.01, bits=16) / 65535.0
        one, other = contact_areas(image, PIXEL), contact_areas(change(image), PIXEL, bright_contacts=bright)
        # single precision of the image; Otsu's threshold is a bin of a histogram, and enters the dark level
        assert np.sort(other.area) == pytest.approx(np.sort(one.area), rel=3e-3 if bright else 1e-4)
        assert contact_areas(image, 2.0 * PIXEL).area == pytest.approx(4.0 * one.area, rel=1e-12)


def test_a_saturated_picture_is_named():
    shape, centre = centres(2, 80, np.random.default_rng(1))
    good, low, high = (
        contact_areas(picture(shape, centre, np.full(4, 20.0), noise=0.05, bits=8, levels=levels), PIXEL)
        for levels in ((0.2, 0.7), (0.02, 0.7), (0.2, 1.0))
    )
    assert ["saturated" in "".join(map(str, one.notes)) for one in (good, low, high)] == [False, True, True]


def test_bad_pixels_and_a_dark_frame_do_not_change_the_areas():
    shape, centre = centres(4, 80, np.random.default_rng(0))
    image = picture(shape, centre, np.full(16, 20.0), noise=0.02, bits=16)
    one = contact_areas(image, PIXEL)
    bad = image.copy()
    bad[5, 7], bad[40, 90] = 65535, 0
    bad[:, -6:] = 200
    found = contact_areas(bad, PIXEL)
    frame = found.edge & (found.axes[:, 0] > 2.0 * found.axes[:, 1])
    assert frame.sum() == 1
    assert found.area[~frame] == pytest.approx(one.area, rel=2e-3)
    spot = contact_areas(image.astype(float) + 1e6 * (image == image.max()), PIXEL)
    assert spot.dark_level == pytest.approx(one.dark_level, abs=0.02)


def test_contacts_too_small_for_their_half_level_are_left_out():
    # one pixel within the half level is a contact of 2.5 pixels, or of any size up to that
    radii = np.append(np.linspace(2.3, 6.0, 40), 30.0)
    centre = [(30.0 * (i % 7) + 20.1, 30.0 * (i // 7) + 20.3) for i in range(40)] + [(290.0, 100.0)]
    found = contact_areas(picture((240, 360), centre, radii), 1.0)
    which = np.linalg.norm(found.centre[:, None] - centre, axis=2).argmin(axis=1)
    assert found.area == pytest.approx(np.pi * radii[which] ** 2, rel=0.01)
    assert found.area.min() >= found.smallest_area
    assert set(which) == set(np.flatnonzero(np.pi * radii**2 > found.smallest_area))


def test_dark_level_and_blur_are_those_of_the_picture():
    for radius, blur in ((8.0, 2.0), (40.0, 0.5)):
        rng = np.random.default_rng(int(radius))
        shape, centre = lattice(3, radius, rng)
        found = contact_areas(picture(shape, centre, np.full(9, radius), blur=blur, noise=0.02, rng=rng), 1.0)
        assert found.dark_level == pytest.approx(DARK / BRIGHT, abs=0.01)
        assert found.blur == pytest.approx(np.sqrt(blur**2 + 1.0 / 12.0), abs=0.06)


def test_contacts_that_cover_a_thousandth_of_the_image():
    # the threshold of Otsu lies in the noise of the ground here
    radii = np.array([6.5, 8.0])
    image = picture(
        (420, 420), [(90.3, 100.0), (310.0, 300.4)], radii, noise=0.1, gradient=(0.15, -0.1), bits=8
    )
    image[200, 50] = 0
    found = contact_areas(image, 1.0)
    exact = np.pi * radii[::-1] ** 2
    assert np.abs(found.area / exact - 1.0).max() < 4.0 * (found.area_error / exact).max() < 0.1
    assert found.dark_level == pytest.approx(DARK / BRIGHT, abs=0.02)
    assert not found.notes


def test_levels_are_those_of_the_largest_load():
    stack = [picture(SHAPE, CENTRE, [1e-6, 1e-6], noise=0.02), *images()]
    found, notes = stack_areas(stack[::-1], PIXEL, loads=[0.4, 0.3, 0.2, 0.1, 0.0])
    found = found[::-1]
    assert found == stack_areas(stack, PIXEL)[0]
    assert contact_areas(stack[-1], PIXEL) == found[-1]
    assert {areas.dark_level for areas in found} == {found[-1].dark_level}
    assert [areas.count for areas in found] == [0, 1, 2, 2, 2]
    assert not notes
    for areas, radius in zip(found[1:], RADII, strict=True):
        exact = np.pi * np.array([r * PIXEL for r in radius if r]) ** 2
        # contacts are numbered from top to bottom
        assert np.abs(areas.area - exact[::-1]).max() < 4.0 * areas.area_error.max()


def test_an_image_that_fails_is_named_and_the_others_are_measured():
    for bad, words, at in ((np.random.default_rng(0).normal(0.05, 0.01, SHAPE), "all dark", 1),
                           (np.zeros(SHAPE), "all dark", 3)):  # fmt: skip
        stack = images()
        rest, _ = stack_areas([image for i, image in enumerate(stack) if i != at], PIXEL)
        stack[at] = bad
        found, notes = stack_areas(stack, PIXEL, names=list("abcd"))
        assert [areas is None for areas in found] == [i == at for i in range(4)]
        assert all(word in str(notes[0]) for word in (f"{'abcd'[at]} is not measured", words))
        for areas, alone in zip([areas for areas in found if areas], rest, strict=True):
            assert np.array_equal(areas.area, alone.area)


def test_gradient_vignetting_and_a_dark_field_are_removed():
    _, centre = lattice(4, 14.0, np.random.default_rng(0))

    def ground(bright, **changes):
        image = picture((240, 300), centre, np.full(16, 14.0), **changes)
        return without_illumination(image.astype(float), bright)

    corrected, mean = ground(False, gradient=(-0.8, 0.5), vignetting=0.2)
    bare = picture((240, 300), centre, np.full(16, 14.0)) / 0.7
    assert corrected == pytest.approx(bare, abs=2e-3)
    assert mean == pytest.approx(0.7 * illumination((240, 300), (-0.8, 0.5), 0.2).mean(), rel=0.01)
    field, _ = ground(True, levels=(0.8, 0.01), noise=0.01)
    assert np.median(field[-40:]) == pytest.approx(1.0, abs=1e-2)
    # the ground is at 178.5, and not at one of the two grey levels beside it
    assert ground(False, noise=0.02, bits=8)[0][-12:].mean() == pytest.approx(1.0, abs=5e-4)


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


@pytest.mark.parametrize(("side", "pitch", "radius"), [(1, 300, 100.0), (5, 66, 30.0), (1, 44, 10.0)])
def test_one_wide_contact_or_two_thirds_of_the_image_are_told_from_the_ground(side, pitch, radius):
    shape, centre = centres(side, pitch, np.random.default_rng(1))
    found = contact_areas(picture(shape, centre, np.full(side**2, radius), noise=0.03, bits=8), 1.0)
    assert found.area == pytest.approx(np.pi * radius**2, rel=3e-3)


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
    place = 70.0 * np.arange(0.5, 4.0)
    image = picture((280, 280), [(x, y) for x in place for y in place], np.full(16, 11.8), blur=4.0)
    assert "wide enough" in str(contact_areas(image, 1.0).notes[0])
    # with the levels of an image of wide contacts the areas are right but for the third order
    wide = picture(*lattice(3, 50.0, np.random.default_rng(1)), np.full(9, 50.0), blur=4.0)
    (known, _), notes = stack_areas([image, wide], 1.0)
    assert not notes
    assert known.area == pytest.approx(11.8**2 * np.pi, rel=0.01)
    narrow = contact_areas(picture((280, 280), [(70.0, 70.0), (200.0, 80.0)], [10.0, 9.0], blur=2.5), 1.0)
    assert "wide enough" in str(narrow.notes[0])
    assert narrow.area == pytest.approx(np.pi * np.array([81.0, 100.0]), rel=0.01)
    found = contact_areas(picture((60, 60), [(0.0, 30.0)], [20.0]), 1.0)
    assert found.edge.all()
    assert "wide enough" in str(found.notes[0])


def test_images_are_read_one_by_one_and_progress_is_reported():
    read, steps = [], []

    def reader(i):
        return lambda: read.append(i) or images()[i]

    with mf.progress.listening(lambda step, done: steps.append(step)):
        stack_areas([reader(i) for i in range(4)], PIXEL, loads=[0.1, 0.2, 0.4, 0.3])
    assert read == [2, 3, 1, 0]
    assert steps == [f"measuring image {i} of 4" for i in (1, 2, 3, 4)]


def test_a_white_frame_is_refused_and_bright_contacts_name_the_option():
    image = picture((160, 200), [(50, 60), (120, 50), (140, 110)], [20.0, 15.0, 25.0], noise=0.02, bits=8)
    found = contact_areas(image, PIXEL)
    assert found.count == 3
    framed = np.pad(image, 6, constant_values=255)
    with pytest.raises(mf.InvalidInput, match="saturated frame"):
        contact_areas(framed, PIXEL)
    with pytest.raises(mf.InvalidInput, match="--bright-contacts"):
        contact_areas(255 - image, PIXEL)
