"""Areas of contacts in synthetic images against the exact areas of the ellipses that are drawn."""

from __future__ import annotations

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import contact_areas, stack_areas
from validation.scenes.pictures import coverage, lattice, picture

PIXEL = 0.005


def centres(side, pitch, rng):
    """Return the shape of a frame and centres [pixels] about the sites of a square lattice."""
    sites = (np.arange(side) + 0.5) * pitch
    x, y = np.meshgrid(sites, sites)
    return (side * pitch, side * pitch), np.stack([x, y], axis=-1).reshape(-1, 2) + rng.uniform(
        -0.5, 0.5, (side * side, 2)
    )


def in_order(found, centre):
    """Return for each drawn contact the number of the found one."""
    distance = np.hypot(*(found.centre[None] / PIXEL - np.asarray(centre)[:, None]).transpose(2, 0, 1))
    assert distance.min(axis=1).max() < 0.5
    return distance.argmin(axis=1)


@pytest.mark.parametrize("radius", [10.0, 25.0])
@pytest.mark.parametrize("blur", [0.8, 2.5])
def test_without_noise_the_correction_leaves_no_bias(radius, blur):
    shape, centre = centres(3, int(4 * radius), np.random.default_rng(3))
    found = contact_areas(picture(shape, centre, np.full(9, radius), blur=blur), PIXEL)
    error = found.area / (np.pi * (radius * PIXEL) ** 2) - 1.0
    # 0.2 square pixels are left of the third order of the curvature, and of the steps between pixels
    assert np.abs(error).max() < 0.2 / (np.pi * radius**2) + 2e-5
    # a pixel adds the variance 1/12 of its square
    assert found.blur / PIXEL == pytest.approx(np.sqrt(blur**2 + 1.0 / 12.0), abs=0.02)


def test_sheared_contacts_are_ellipses():
    shape, centre = centres(4, 90, np.random.default_rng(4))
    rng = np.random.default_rng(5)
    axes = np.sort(rng.uniform(12.0, 30.0, (16, 2)))[:, ::-1]
    angle = rng.uniform(-1.5, 1.5, 16)
    found = contact_areas(picture(shape, centre, axes, angle, gradient=(0.3, -0.2), vignetting=0.1), PIXEL)
    which = in_order(found, centre)
    exact = np.pi * axes.prod(axis=1) * PIXEL**2
    assert found.area[which] == pytest.approx(exact, rel=1e-3)
    assert found.centre[which] == pytest.approx(centre * PIXEL, abs=0.02 * PIXEL)
    assert found.axes[which] == pytest.approx(axes * PIXEL, rel=2e-3)
    turned = (found.angle[which] - angle + 0.5 * np.pi) % np.pi - 0.5 * np.pi
    assert np.abs(turned * (1.0 - axes[:, 1] / axes[:, 0])).max() < 2e-3
    assert found.complete.all()
    assert not found.notes


@pytest.mark.parametrize("noise", [0.02, pytest.param(0.1, marks=pytest.mark.slow)])
def test_reported_errors_are_the_scatter(noise):
    radius, rng = 15.0, np.random.default_rng(6)
    shape, centre = centres(10, 60, rng)
    found = contact_areas(picture(shape, centre, np.full(100, radius), noise=noise, rng=rng), PIXEL)
    error = found.area - np.pi * (radius * PIXEL) ** 2
    ratio = np.sqrt(np.mean((error / found.area_error) ** 2))
    assert ratio == pytest.approx(1.0, abs=0.2)
    assert found.noise == pytest.approx(noise, rel=0.1)
    # the Cramer-Rao bound of a straight edge as long as the perimeter
    s = np.hypot(1.5, np.sqrt(1.0 / 12.0))
    bound = noise * np.sqrt(2.0 * np.sqrt(np.pi) * s * 2.0 * np.pi * radius) * PIXEL**2
    assert error.std() == pytest.approx(bound, rel=0.2)


def test_flags_name_contacts_at_the_edge_merged_and_with_holes():
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
    assert found.holes.tolist() == [0, 1, 0, 0]
    ring = found.holes.argmax()
    assert found.area[ring] == pytest.approx(np.pi * (20.0**2 - 6.0**2) * PIXEL**2, rel=1e-3)
    texts = " ".join(map(str, found.notes))
    assert all(word in texts for word in ("edge of the frame", "merged", "bright spots", "1 dark spot"))


def test_bright_contacts_are_the_inverted_picture():
    shape, centre = centres(2, 80, np.random.default_rng(1))
    radius = np.array([10.0, 15.0, 20.0, 25.0])
    bright = picture(shape, centre, radius, levels=(0.8, 0.3), gradient=(0.2, 0.1), noise=0.01)
    found = contact_areas(bright, PIXEL, bright_contacts=True)
    assert found.area[in_order(found, centre)] == pytest.approx(np.pi * (radius * PIXEL) ** 2, rel=3e-3)
    field = picture(shape, centre, radius, levels=(0.8, 0.02), noise=0.01)
    found = contact_areas(field, PIXEL, bright_contacts=True)
    assert found.area[in_order(found, centre)] == pytest.approx(np.pi * (radius * PIXEL) ** 2, rel=3e-3)


@pytest.mark.parametrize("change", [lambda i: 3.0 * i, lambda i: i[::-1].T, lambda i: i - 1.0])
def test_areas_do_not_depend_on_scale_and_direction(change):
    shape, centre = centres(2, 80, np.random.default_rng(1))
    image = picture(shape, centre, [12.0, 15.0, 20.0, 25.0], noise=0.01, bits=16) / 65535.0
    one, other = contact_areas(image, PIXEL), contact_areas(change(image), PIXEL)
    # single precision of the image; Otsu's threshold is a bin of a histogram, and enters the dark level
    assert np.sort(other.area) == pytest.approx(np.sort(one.area), rel=1e-4)


def test_units_scale_and_bits_agree():
    shape, centre = centres(2, 80, np.random.default_rng(1))
    image = picture(shape, centre, [12.0, 15.0, 20.0, 25.0], noise=0.02, bits=8)
    one, two = contact_areas(image, PIXEL), contact_areas(image, 2.0 * PIXEL)
    assert two.area == pytest.approx(4.0 * one.area, rel=1e-12)
    assert two.centre == pytest.approx(2.0 * one.centre, rel=1e-12)
    colour = contact_areas(np.repeat(image[..., None], 3, axis=2), PIXEL)
    assert colour == one
    again = contact_areas(image, PIXEL, threshold=one.threshold, dark_level=one.dark_level, blur=one.blur)
    assert again.area == pytest.approx(one.area, rel=1e-6)


def test_saturated_contacts_and_ground_are_named():
    shape, centre = centres(2, 80, np.random.default_rng(1))
    good = picture(shape, centre, np.full(4, 20.0), noise=0.05, bits=8)
    assert not contact_areas(good, PIXEL).saturated.any()
    low = picture(shape, centre, np.full(4, 20.0), noise=0.05, bits=8, levels=(0.02, 0.7))
    assert contact_areas(low, PIXEL).saturated.all()
    high = picture(shape, centre, np.full(4, 20.0), noise=0.05, bits=8, levels=(0.2, 1.0))
    found = contact_areas(high, PIXEL)
    assert found.saturated.all()
    assert "saturated" in str(found.notes[-1])


@pytest.mark.parametrize(
    ("image", "words"),
    [
        (np.full((50, 50), 7), "constant"),
        (np.random.default_rng(0).normal(200.0, 5.0, (100, 100)), "shows no contacts"),
        (np.random.default_rng(0).normal(5.0, 1.0, (100, 100)).astype(np.uint8), "shows no contacts"),
        (picture((420, 420), [(90.3, 100.0)], [1e-6], noise=0.1, bits=8), "shows no contacts"),
        (np.where(np.eye(50) > 0, np.nan, 1.0), "row 0, column 0"),
        (np.random.default_rng(0).random((50, 50, 3)), "in colour"),
        (np.zeros((4, 50, 50)), "stack_areas"),
        (np.zeros((5, 50)), "at least 16"),
        (np.eye(50) > 0, "entries are bool"),
        ("picture.tif", "metafem images"),
        ([[1.0, 2.0], [3.0]], "array of grey values"),
    ],
)
def test_images_that_cannot_be_measured_are_refused(image, words):
    with pytest.raises(mf.InvalidInput, match=words):
        contact_areas(image, PIXEL)


@pytest.mark.parametrize(
    "arguments",
    [{"pixel_size": 0.0}, {"threshold": 1.2}, {"dark_level": 1.0}, {"blur": -1.0}, {"smallest_area": -1.0}],
)
def test_values_out_of_range_are_refused(arguments):
    with pytest.raises(mf.InvalidInput, match=next(iter(arguments))):
        contact_areas(np.eye(50), **{"pixel_size": PIXEL, **arguments})


@pytest.mark.slow
def test_counted_areas_carry_their_bias_as_error():
    rng = np.random.default_rng(0)
    shape, centre = centres(8, 40, rng)
    image = picture(shape, centre, np.full(64, 10.0), noise=0.05, rng=rng)
    found = contact_areas(image, PIXEL, subpixel=False)
    assert np.array_equal(found.area, found.otsu_area)
    error = found.area - np.pi * (10.0 * PIXEL) ** 2
    assert np.sqrt(np.mean((error / found.area_error) ** 2)) == pytest.approx(1.0, abs=0.25)


def test_a_threshold_in_the_contacts_is_refused():
    image = picture((80, 80), [(40.0, 40.0)], [20.0], noise=0.02)
    with pytest.raises(mf.InvalidInput, match="must be above the grey level"):
        contact_areas(image, PIXEL, threshold=0.1)


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
    assert spot.threshold == pytest.approx(one.threshold, abs=0.02)


@pytest.mark.parametrize("other", [9.0, 15.0, 30.0])
@pytest.mark.parametrize("gap", [-2.0, 0.0, 2.0, 6.0])
def test_contacts_that_touch_are_named_as_merged(other, gap):
    radius = np.array([30.0, other])
    centre = [(60.0, 60.0), (90.0 + other + gap, 60.0)]
    found = contact_areas(picture((120, 180), centre, radius, noise=0.03), PIXEL)
    if gap > 4.0:
        assert found.complete.tolist() == [True, True]
    else:
        assert found.merged.tolist() == [True]
        assert found.area[0] == pytest.approx(np.pi * (radius**2).sum() * PIXEL**2, rel=0.01)


SHAPE, CENTRE = (120, 120), [(30.0, 30.0), (85.0, 80.0)]
RADII = ([6.0, 0.0], [9.0, 7.0], [16.0, 14.0], [24.0, 20.0])


def images(**changes):
    return [
        picture(SHAPE, CENTRE, np.maximum(radius, 1e-6), rng=i, **{"noise": 0.02, **changes})
        for i, radius in enumerate(RADII)
    ]


def test_levels_are_those_of_the_largest_load():
    stack = images()
    found = stack_areas(stack[::-1], PIXEL, loads=[0.4, 0.3, 0.2, 0.1])[::-1]
    assert found == stack_areas(stack, PIXEL)
    last = contact_areas(stack[-1], PIXEL)
    assert last == found[-1]
    assert {areas.threshold for areas in found} == {last.threshold}
    assert [areas.count for areas in found] == [1, 2, 2, 2]
    for areas, radius in zip(found, RADII, strict=True):
        exact = np.pi * np.array([r * PIXEL for r in radius if r]) ** 2
        # contacts are numbered from top to bottom
        assert np.abs(areas.area - exact[::-1]).max() < 4.0 * areas.area_error.max()
        assert not areas.notes


def test_an_open_image_has_no_contacts_and_has_not_failed():
    stack = [picture(SHAPE, CENTRE, [1e-6, 1e-6], noise=0.02), *images()]
    assert (stack_areas(stack, PIXEL)[0].count, stack_areas(stack, PIXEL)[0].failed) == (0, False)


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        (np.zeros(SHAPE), "constant"),
        (np.random.default_rng(0).normal(0.05, 0.01, SHAPE), "all dark"),
        (np.full(SHAPE, np.nan), "must be finite"),
        ("lost.tif", "is a name"),
    ],
)
@pytest.mark.parametrize("at", [1, 3])
def test_an_image_that_fails_is_named_and_the_others_are_measured(bad, words, at):
    stack = images()
    rest = stack_areas([image for i, image in enumerate(stack) if i != at], PIXEL)
    stack[at] = bad
    found = stack_areas(stack, PIXEL)
    assert [areas.failed for areas in found] == [i == at for i in range(4)]
    assert f"images[{at}] is not measured" in str(found[at].notes[0])
    assert words in str(found[at].notes[0])
    assert found[at].count == 0
    for areas, alone in zip([areas for areas in found if not areas.failed], rest, strict=True):
        assert np.array_equal(areas.area, alone.area)
    if at == 3:
        assert "levels are from images[2], because images[3] cannot" in str(found[2].notes[-1])


def test_images_are_read_one_by_one_and_progress_is_reported():
    read = []

    class Lazy:
        def __len__(self):
            return 4

        def __getitem__(self, i):
            read.append(i)
            return images()[i]

    steps = []
    with mf.progress.listening(lambda step, done: steps.append(step)):
        stack_areas(Lazy(), PIXEL, loads=[0.1, 0.2, 0.4, 0.3])
    assert read == [2, 3, 1, 0]
    assert steps == [f"measuring image {i} of 4" for i in (1, 2, 3, 4)]


def test_stacks_without_an_image_to_measure_are_refused():
    with pytest.raises(mf.InvalidInput, match=r"none of the images .* images\[1\]"):
        stack_areas([np.zeros(SHAPE), np.ones(SHAPE)], PIXEL)
    with pytest.raises(mf.InvalidInput, match="at least one"):
        stack_areas([], PIXEL)
    with pytest.raises(mf.InvalidInput, match="sequence"):
        stack_areas(iter(images()), PIXEL)
    with pytest.raises(mf.InvalidInput, match="loads has 2 numbers; it must have 4"):
        stack_areas(images(), PIXEL, loads=[1.0, 2.0])


@pytest.mark.parametrize(("dark", "words"), [(0.2, ""), (0.23, "brighter by"), (0.17, "darker by")])
def test_contacts_of_another_grey_level_are_named_and_their_errors_contain_it(dark, words):
    rng = np.random.default_rng(0)
    shape, centre = lattice(4, 16.0, rng)
    largest = picture(shape, centre, np.full(16, 18.0), noise=0.05, bits=8, rng=rng)
    image = picture(shape, centre, np.full(16, 12.0), noise=0.05, bits=8, rng=rng, levels=(dark, 0.7))
    found = stack_areas([image, largest], 1.0)
    away = (found[0].area - 144.0 * np.pi) / found[0].area_error
    assert np.sqrt(np.mean(away**2)) < 1.5
    assert not found[1].notes
    assert bool(words) == bool(found[0].notes)
    assert words in "".join(map(str, found[0].notes))
