"""The images of compression and of shear tests that are used, and what is said of the others."""

import numpy as np
import pandas as pd
import pytest

from metafem.calibration import MeasurementErrors, contact_table, shear
from metafem.calibration.contact_table import pressed_points, sheared_points

LIMIT = 0.01
QUANTITIES = ["area_before", "area_sheared", "friction_force"]


def table(load, force, site, *areas):
    """Return the table of images 1.tif, 2.tif and so on from areas and their errors."""
    count, contacts = areas[0].shape
    names = [f"{i + 1}.tif" for i in range(count)]
    forces = pd.DataFrame({"image": names, "test": "", "load": load, "friction_force": force})
    return contact_table(forces, np.zeros((contacts, 2)), site, *areas)


def pressed(area, load=0.1, matched=False):
    area = np.array(area)
    return table(load, np.nan, 10 + np.arange(area.shape[1]) if matched else None, area, 0.01 * area)


def sheared(before, after, force=0.1):
    areas = [np.array(before, dtype=float), np.array(after, dtype=float)]
    errors = [np.where(area == 0.0, LIMIT, 0.01 * area) for area in areas]
    return table(np.nan, force, None, areas[0], errors[0], areas[1], errors[1])


PRESSED = [
    (pressed([[0.1, 0.2], [0.1, 0.0]]), [0, 1], [], []),
    (pressed([[0.1, 0.2], [0.1, np.nan], [0.2, 0.3]]), [0, 2], ["contact 2"], [True]),
    (pressed([[0.1, 0.2], [0.1, np.nan], [0.2, 0.3]], matched=True), [0, 2], ["site 11"], [True]),
    (pressed([[0.1, np.nan], [0.2, np.nan], [0.3, 0.3]], [0.1, 0.2, np.nan]), [], ["contact 2"], [True]),
    (pressed([[0.1, 0.2], [0.0, 0.0]]), [0], ["2.tif"], [True]),
]


def test_images_and_contacts_that_are_left_out_are_named():
    for table, used, words, warns in PRESSED:
        found, notes = pressed_points(table)
        assert found.index.tolist() == used
        assert [note.warns for note in notes] == warns
        assert all(word in str(note) for word, note in zip(words, notes, strict=True))


SHEARED = [
    ([[0.1, 0.2], [0.1, 0.0]], [[0.08, 0.16], [0.08, 0.0]], [[0.3, 0.24, 0.1, 0], [0.1, 0.08, 0.1, 1]], []),
    # a contact that was not measured before shear takes only itself from the ratio
    ([[0.1, np.nan]], [[0.08, 0.16]], [[0.1, 0.08, None, 0], [None, 0.24, 0.1, 0]], []),
    ([[np.nan, np.nan]], [[0.08, 0.16]], [[None, 0.24, 0.1, 0]], []),
    ([[0.1, 0.2]], [[0.08, np.nan]], [[0.1, 0.08, None, 0]], ["1.tif"]),
    # a contact that falls below the smallest area is not taken as open
    ([[0.1, 0.011]], [[0.08, 0.0]], [[0.1, 0.08, None, 0]], ["1.tif"]),
    ([[0.1, 0.0]], [[0.08, 0.011]], [[0.1, 0.08, None, 0]], ["1.tif"]),
]


def test_images_are_points_of_what_they_show():
    for before, after, expected, words in SHEARED:
        points, notes = sheared_points(sheared(before, after))
        rows = points[QUANTITIES].reset_index().to_numpy()[:, [1, 2, 3, 0]].tolist()
        assert [[None if np.isnan(x) else round(x, 12) for x in row] for row in rows] == expected
        assert all(word in str(note) for word, note in zip(words, notes, strict=True))


def test_contacts_near_the_smallest_area_bias_neither_ratio_nor_strength():
    """With 3 % of noise and areas of 1 to 3 times the smallest one; open contacts would bias B by -5 %."""
    rng, ratio, strength = np.random.default_rng(0), 0.85, 0.4
    area = LIMIT * rng.uniform(1.0, 3.0, (1500, 8))
    measured = [true * (1.0 + 0.03 * rng.standard_normal(area.shape)) for true in (area, ratio * area)]
    before, after = (np.where(each > LIMIT, each, 0.0) for each in measured)
    points, _ = sheared_points(sheared(before, after, strength * ratio * area.sum(axis=1)))
    found = shear(*points[QUANTITIES].to_numpy().T, errors=MeasurementErrors())
    assert after.sum() / before.sum() / ratio < 0.98
    assert found.estimates["area_ratio"].value == pytest.approx(ratio, rel=0.003)
    assert found.estimates["shear_strength"].value == pytest.approx(strength, rel=0.005)
