"""Stacks: one threshold, levels from the largest load, and images that cannot be measured."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import contact_areas, stack_areas
from validation.scenes.pictures import lattice, picture

PIXEL, SHAPE, CENTRE = 0.005, (120, 120), [(30.0, 30.0), (85.0, 80.0)]
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
    with pytest.raises(mf.InvalidInput, match="loads has"):
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
