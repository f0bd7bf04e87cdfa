"""Areas of the contacts in a series of images, with the measured forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._given import printable
from metafem._validate import FloatArray
from metafem._values import Value

# Images or contacts that a sentence names, so that it stays readable.
NAMED = 5


@dataclass(frozen=True, eq=False, repr=False)
class ContactTable(Value):
    """Areas of n contacts in k images, and the forces at which the images were taken.

    A contact that an image does not show counts as open: its area is 0, and its error the smallest area that
    the image shows, below which a contact is overlooked. One that could not be measured, at the edge of the
    frame or merged with another, has the area nan, and `remarks` names it.

    Attributes
    ----------
    image : tuple of str, (k,)
        Names of the images.
    test : tuple of str, (k,)
        Name of the test of each image.
    load, friction_force : ndarray, (k,)
        Normal load and friction force [N]; nan where they were not measured.
    position : ndarray, (n, 2)
        Sites of the contacts [mm]: those of the lattice if they were matched, else their mean centres.
    site : ndarray of int, (n,)
        Numbers of the sites in the design, or 0 to n - 1 if the contacts were not matched.
    matched : bool
        Whether the contacts were matched to the sites of a lattice.
    area, area_error : ndarray, (k, n)
        Contact areas and their standard deviations [mm^2].
    sheared_area, sheared_area_error : ndarray, (k, n)
        The same in the images at the peak of the friction force; nan where there is none.
    remarks : tuple of str
        What could not be measured, with image and contact.

    Examples
    --------
    >>> one, none = np.array([[0.1, 0.0]]), np.full((1, 2), np.nan)
    >>> table = ContactTable(
    ...     ("1.tif",), ("",), np.array([0.05]), np.array([np.nan]), np.array([[0.0, 0.0], [1.5, 0.0]]),
    ...     np.arange(2), False, one, 0.01 * one, none, none,
    ... )
    >>> table.area.sum(axis=1)
    array([0.1])
    """

    image: tuple[str, ...]
    test: tuple[str, ...]
    load: FloatArray
    friction_force: FloatArray
    position: FloatArray
    site: NDArray[np.intp]
    matched: bool
    area: FloatArray
    area_error: FloatArray
    sheared_area: FloatArray
    sheared_area_error: FloatArray
    remarks: tuple[str, ...] = ()

    def name_of(self, contact: int) -> str:
        """Return the name of a contact in tables and remarks.

        Parameters
        ----------
        contact : int
            Its column, counted from 0.

        Examples
        --------
        >>> one, none = np.array([[0.1]]), np.full((1, 1), np.nan)
        >>> ContactTable(
        ...     ("1.tif",), ("",), np.array([0.05]), np.array([np.nan]), np.zeros((1, 2)), np.array([7]),
        ...     False, one, 0.01 * one, none, none,
        ... ).name_of(0)
        'contact 1'
        """
        return f"site {self.site[contact]}" if self.matched else f"contact {contact + 1}"


def listed(names: Sequence[str]) -> str:
    """Return names of images or contacts in a sentence.

    Examples
    --------
    >>> listed(["1.tif", "2.tif", "3.tif", "4.tif", "5.tif", "6.tif", "7.tif"])
    '1.tif, 2.tif, 3.tif, 4.tif, 5.tif and 2 more'
    """
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(printable(name, 60) for name in names[:NAMED]) + more
