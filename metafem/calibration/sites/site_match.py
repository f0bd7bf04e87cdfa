"""The sites of the contacts in one image, as a value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.sites.search import IntArray
from metafem.calibration.sites.similarity import complex_points, real_points
from metafem.notes import Note


@dataclass(frozen=True, eq=False, repr=False)
class SiteMatch(Value):
    """The sites of the contacts in an image.

    A site x of the design is seen at ``scale R(rotation) M x + shift``, with the rotation matrix R and
    M = diag(-1, 1) if the image is mirrored, else 1.

    Attributes
    ----------
    site : ndarray of int, (n,)
        Index of the site of each contact in ``site_position``; -1 where a region lies on no site.
    shift : ndarray, (2,)
        Position at which the design's origin is seen [mm].
    rotation : float
        Anticlockwise rotation of the design in the image [rad].
    scale : float
        Lengths in the image over those in the design [-].
    mirrored : bool
        Whether the design is seen mirrored, x -> -x, as through the block.
    residual : float
        Root mean square of the distances of the matched contacts from their sites [mm].
    ambiguous : bool
        Whether the contacts match as well with another shift, for example by one pitch.
    notes : tuple of Note

    Examples
    --------
    >>> sites = [[0.0, 0.0], [1.5, 0.0], [3.0, 0.0], [0.0, 1.5]]
    >>> from metafem.calibration import match_sites
    >>> found = match_sites([[3.5, 6.0], [3.5, 4.5], [5.0, 4.5], [6.5, 4.5]], sites)
    >>> found.site, found.shift.round(6), found.to_image([[3.0, 1.5]]).round(6)
    (array([3, 0, 1, 2]), array([3.5, 4.5]), array([[6.5, 6. ]]))
    """

    site: IntArray
    shift: FloatArray
    rotation: float
    scale: float
    mirrored: bool
    residual: float
    ambiguous: bool
    notes: tuple[Note, ...] = ()

    def to_image(self, position: ArrayLike) -> FloatArray:
        """Return where points of the design (m, 2) are seen in the image [mm]."""
        factor = self.scale * np.exp(1j * self.rotation)
        points = complex_points(np.asarray(position, dtype=np.float64), self.mirrored)
        return real_points(factor * points) + self.shift

    def to_design(self, position: ArrayLike) -> FloatArray:
        """Return the points of the design that are seen at points of the image (m, 2) [mm]."""
        factor = self.scale * np.exp(1j * self.rotation)
        points = complex_points(np.asarray(position, dtype=np.float64) - self.shift) / factor
        return real_points(-points.conj() if self.mirrored else points)
