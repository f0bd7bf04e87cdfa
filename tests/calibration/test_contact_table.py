"""The images of compression and of shear tests that are used, and what is said of the others."""

from __future__ import annotations

import numpy as np
import pytest

from metafem.calibration import ContactTable, MeasurementErrors, shear
from metafem.calibration.contact_table import pressed_images, sheared_points

LIMIT = 0.01


def pressed(area, load=None, matched=False):
    area = np.array(area, dtype=float)
    count, contacts = area.shape
    none = np.full(area.shape, np.nan)
    names = tuple(f"{i + 1}.tif" for i in range(count))
    load = np.full(count, 0.1) if load is None else np.array(load)
    position, site = np.zeros((contacts, 2)), 10 + np.arange(contacts)
    return ContactTable(
        names, ("",) * count, load, load * np.nan, position, site, matched, area, 0.01 * area, none, none
    )


def test_complete_images_are_used_without_a_note():
    used, notes = pressed_images(pressed([[0.1, 0.2], [0.1, 0.0]]))
    assert (used.tolist(), notes) == ([0, 1], ())


@pytest.mark.parametrize(("matched", "name"), [(False, "contact 2"), (True, "site 11")])
def test_images_and_contacts_that_are_left_out_are_named(matched, name):
    used, (note,) = pressed_images(pressed([[0.1, 0.2], [0.1, np.nan], [0.2, 0.3]], matched=matched))
    assert used.tolist() == [0, 2]
    assert str(note) == (
        f"E* is fitted to 2 of the 3 images with a load: in 2.tif the area of {name} could not be measured, "
        "and the load is that of all contacts"
    )
    assert not note.warns


def test_a_contact_that_no_image_measures_is_a_warning():
    used, notes = pressed_images(pressed([[0.1, np.nan], [0.2, np.nan], [0.3, 0.3]], load=[0.1, 0.2, np.nan]))
    assert used.size == 0
    assert "the area of contact 2, so that E* cannot be fitted" in str(notes[1])
    assert notes[1].warns


def test_images_without_a_contact_are_named():
    used, (note,) = pressed_images(pressed([[0.1, 0.2], [0.0, 0.0]]))
    assert (used.tolist(), str(note)) == ([0], "E* is fitted without 2.tif: no contact was found there")


def sheared(before, after, force=None):
    before, after = np.array(before, dtype=float), np.array(after, dtype=float)
    count, contacts = before.shape
    force = np.full(count, 0.1) if force is None else np.array(force, dtype=float)
    errors = [
        np.where(area > 0.0, 0.01 * area, np.where(area == 0.0, LIMIT, np.nan)) for area in (before, after)
    ]
    names = tuple(f"{i + 1}.tif" for i in range(count))
    position = np.zeros((contacts, 2))
    return ContactTable(
        *(names, ("",) * count, force * np.nan, force, position, np.arange(contacts), False),
        *(before, errors[0], after, errors[1]),
    )


def points_of(*given):
    """Return the points with their images as rows, and the notes."""
    points, image, notes = sheared_points(sheared(*given))
    rows = np.vstack([points, image]).T.tolist()
    return [[None if np.isnan(x) else round(x, 12) for x in row] for row in rows], notes


@pytest.mark.parametrize(
    ("before", "after", "expected", "words"),
    [
        (
            [[0.1, 0.2], [0.1, 0.0]],
            [[0.08, 0.16], [0.08, 0.0]],
            [[0.3, 0.24, 0.1, 0], [0.1, 0.08, 0.1, 1]],
            "",
        ),
        # a contact that was not measured before shear takes only itself from the ratio
        ([[0.1, np.nan]], [[0.08, 0.16]], [[0.1, 0.08, None, 0], [None, 0.24, 0.1, 0]], ""),
        ([[np.nan, np.nan]], [[0.08, 0.16]], [[None, 0.24, 0.1, 0]], ""),
        (
            *([[0.1, 0.2]], [[0.08, np.nan]], [[0.1, 0.08, None, 0]]),
            "sigma is fitted without 1.tif: the sheared area of contact 2 could not",
        ),
        ([[0.0, 0.0], [0.1, 0.0]], [[0.0, 0.0], [0.0, 0.0]], [], None),
    ],
)
def test_images_are_points_of_what_they_show(before, after, expected, words):
    points, notes = points_of(before, after)
    assert points == expected
    assert words is None or " ".join(map(str, notes)).startswith(words)
    assert words != "" or notes == ()


@pytest.mark.parametrize(("area", "filled"), [(0.011, 0.0088), (0.1, LIMIT)])
def test_a_contact_that_falls_below_the_smallest_area_is_not_taken_as_open(area, filled):
    points, (note,) = points_of([[0.1, area]], [[0.08, 0.0]])
    assert points == [[0.1, 0.08, None, 0], [None, 0.08 + filled, 0.1, 0]]
    assert "1.tif: contacts are below the smallest area" in str(note)


def test_a_contact_that_only_the_sheared_image_shows_is_part_of_the_strength_alone():
    points, _ = points_of([[0.1, 0.0]], [[0.08, 0.011]])
    assert points == [[0.1, 0.08, None, 0], [None, 0.091, 0.1, 0]]


def test_contacts_near_the_smallest_area_bias_neither_ratio_nor_strength():
    """With 3 % of noise and areas of 1 to 3 times the smallest one; open contacts would bias B by -5 %."""
    rng, ratio, strength = np.random.default_rng(0), 0.85, 0.4
    area = LIMIT * rng.uniform(1.0, 3.0, (1500, 8))
    measured = [true * (1.0 + 0.03 * rng.standard_normal(area.shape)) for true in (area, ratio * area)]
    before, after = (np.where(each > LIMIT, each, 0.0) for each in measured)
    force = strength * ratio * area.sum(axis=1)
    points, _, _ = sheared_points(sheared(before, after, force))
    found = shear(*points, errors=MeasurementErrors())
    plain = after.sum() / before.sum() / ratio - 1.0
    assert plain < -0.02
    assert found.area_ratio == pytest.approx(ratio, rel=0.003)
    assert found.shear_strength == pytest.approx(strength, rel=0.005)
