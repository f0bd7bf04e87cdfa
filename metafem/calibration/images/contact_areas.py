"""Contacts found in an image, with their areas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.notes import Note


@dataclass(frozen=True, eq=False, repr=False)
class ContactAreas(Value):
    """The n contacts in one image, ordered from the top to the bottom of the frame.

    Attributes
    ----------
    area, area_error : ndarray, (n,)
        Contact areas and their standard deviations [mm^2]. For a contact at the edge of the frame, the area
        is the visible part; for merged contacts it is their total.
    otsu_area : ndarray, (n,)
        Contact areas by pixel count: number of pixels below Otsu's threshold times the area of a pixel
        [mm^2].
    centre : ndarray, (n, 2)
        Centres [mm], with x to the right and y upwards from the lower left corner of the frame. The centre of
        the lower left pixel is at half a pixel in x and y.
    axes : ndarray, (n, 2)
        Semi-axes of the ellipses with the second moments of the contacts, the longer axis first [mm].
    angle : ndarray, (n,)
        Angle of the longer axis from the x axis, anticlockwise, from -pi/2 to pi/2 [rad].
    edge, merged, saturated : ndarray of bool, (n,)
        Whether a contact is at the edge of the frame, consists of merged contacts, or is saturated: more than
        1 % of the grey levels of the contact or of the ground are at an end of the scale.
    holes : ndarray of int, (n,)
        Number of bright spots within each contact, which do not count as contact area.
    threshold, dark_level : float
        Otsu's threshold and the grey level of wide contacts, both over the grey level of the ground [-].
    blur : float
        Standard deviation of the Gaussian blur of the contact edges [mm].
    noise : float
        Standard deviation of the noise of a pixel over the contrast, measured at the scale of the blur [-].
    pixel_size : float
        Side of a pixel [mm].
    shape : tuple of int
        Rows and columns of the image.
    smallest_area : float
        Area below which a dark region does not count as a contact [mm^2].
    failed : bool
        Whether the measurement of the image failed. There are then no contacts, and `notes` states the
        reason.
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
        """Whether each contact is neither at the edge of the frame nor merged, (n,)."""
        return ~(self.edge | self.merged)
