"""Images of contacts of which E* is fitted: those of which all contacts were measured."""

import numpy as np
import pytest

from metafem.calibration import ContactTable
from metafem.calibration.contact_table import pressed_images


def table(area, load=None, matched=False):
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
    used, notes = pressed_images(table([[0.1, 0.2], [0.1, 0.0]]))
    assert (used.tolist(), notes) == ([0, 1], ())


@pytest.mark.parametrize(("matched", "name"), [(False, "contact 2"), (True, "site 11")])
def test_images_and_contacts_that_are_left_out_are_named(matched, name):
    used, (note,) = pressed_images(table([[0.1, 0.2], [0.1, np.nan], [0.2, 0.3]], matched=matched))
    assert used.tolist() == [0, 2]
    assert str(note) == (
        f"E* is fitted to 2 of the 3 images with a load: in 2.tif the area of {name} could not be measured, "
        "and the load is that of all contacts"
    )
    assert not note.warns


def test_a_contact_that_no_image_measures_is_a_warning():
    used, notes = pressed_images(table([[0.1, np.nan], [0.2, np.nan], [0.3, 0.3]], load=[0.1, 0.2, np.nan]))
    assert used.size == 0
    assert "the area of contact 2, so that E* cannot be fitted" in str(notes[1])
    assert notes[1].warns


def test_images_without_a_contact_are_named():
    used, (note,) = pressed_images(table([[0.1, 0.2], [0.0, 0.0]]))
    assert (used.tolist(), str(note)) == ([0], "E* is fitted without 2.tif: no contact was found there")
