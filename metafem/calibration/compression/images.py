"""The images of contacts of which E* and adhesion energy are fitted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from metafem.calibration.contact_table import ContactTable, listed
from metafem.notes import Note, information


def pressed_images(table: ContactTable) -> tuple[NDArray[np.intp], tuple[Note, ...]]:
    """Return the numbers of the images that are used, and notes on those that are left out.

    The load is that of all contacts. Where the area of one is unknown, its load is one more unknown in the
    only equation of the image, which then says nothing about E*. A smaller sum of areas would.
    """
    loaded, known = np.isfinite(table.load), np.isfinite(table.area)
    whole = loaded & known.all(axis=1)
    touching = (table.area > 0.0).any(axis=1)
    notes = []
    left = np.flatnonzero(loaded & ~whole)
    if left.size:
        missing = np.flatnonzero(~known[left].all(axis=0)).tolist()
        notes.append(
            information(
                f"E* is fitted to {int((whole & touching).sum())} of the {int(loaded.sum())} images with a "
                f"load: in {listed([table.image[i] for i in left.tolist()])} the area of "
                f"{listed([table.name_of(j) for j in missing])} could not be measured, and the load is that "
                "of all contacts"
            )
        )
    never = np.flatnonzero(~known[loaded].any(axis=0)).tolist() if loaded.any() else []
    if never:
        notes.append(
            Note(
                f"no image with a load has the area of {listed([table.name_of(j) for j in never])}, so that "
                "E* cannot be fitted: take images of all contacts"
            )
        )
    empty = np.flatnonzero(whole & ~touching).tolist()
    if empty:
        names = listed([table.image[i] for i in empty])
        notes.append(information(f"E* is fitted without {names}: no contact was found there"))
    return np.flatnonzero(whole & touching), tuple(notes)
