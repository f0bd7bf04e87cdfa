"""The contacts found in an image."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.notes import Note


@dataclass(frozen=True, eq=False, repr=False)
class ContactAreas(Value):
    """The n contacts in one image, from top to bottom of the frame.

    Attributes
    ----------
    area, area_error : ndarray, (n,)
        Contact areas and their standard deviations [mm^2]. Contacts at the edge of the frame or merged with
        another have the visible area.
    otsu_area : ndarray, (n,)
        Number of pixels below Otsu's threshold, times the area of a pixel [mm^2].
    centre : ndarray, (n, 2)
        Centres [mm]: x to the right and y upwards, from the lower left corner of the frame. A pixel is a
        square; the centre of the lower left one is at half a pixel.
    axes : ndarray, (n, 2)
        Semi-axes of the ellipses with the same second moments, the longer one first [mm].
    angle : ndarray, (n,)
        Direction of the longer axis from x, anticlockwise, from -pi/2 to pi/2 [rad].
    edge, merged, saturated : ndarray of bool, (n,)
        Whether the contact is at the edge of the frame; whether its outline has the waist of two merged
        contacts; whether more than 1 % of the grey levels of the contact or of the ground are at an end of
        the scale.
    holes : ndarray of int, (n,)
        Number of bright spots within the contact; they do not count as area.
    threshold, dark_level : float
        Otsu's threshold and the grey level of wide contacts, over the grey level of the ground [-].
    blur : float
        Standard deviation of the Gaussian that blurs a step to the edges of the contacts [mm].
    noise : float
        Standard deviation of the grey levels over the contrast, at the scale of the blur [-].
    pixel_size : float
        Side of a pixel [mm].
    shape : tuple of int
        Rows and columns of the image.
    smallest_area : float
        Area below which a dark region does not count as a contact [mm^2].
    failed : bool
        Whether the image could not be measured; `notes` state the reason, and there are no contacts.
    notes : tuple of Note

    Examples
    --------
    >>> import metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> found = mf.calibration.contact_areas(image, pixel_size=0.005)
    >>> found.count, found.complete.all(), found.centre.round(4)
    (1, np.True_, array([[0.2025, 0.1475]]))
    """

    area: FloatArray
    area_error: FloatArray
    otsu_area: FloatArray
    centre: FloatArray
    axes: FloatArray
    angle: FloatArray
    edge: NDArray[np.bool_]
    merged: NDArray[np.bool_]
    saturated: NDArray[np.bool_]
    holes: IntArray
    threshold: float
    dark_level: float
    blur: float
    noise: float
    pixel_size: float
    shape: tuple[int, int]
    smallest_area: float = 0.0
    failed: bool = False
    notes: tuple[Note, ...] = ()

    @property
    def count(self) -> int:
        """Number of contacts."""
        return len(self.area)

    @property
    def frame(self) -> FloatArray:
        """Width and height of the image, (2,) [mm]."""
        return self.pixel_size * np.array(self.shape[::-1])

    @property
    def complete(self) -> NDArray[np.bool_]:
        """Whether each contact is neither at the edge of the frame nor merged with another."""
        return ~(self.edge | self.merged)
