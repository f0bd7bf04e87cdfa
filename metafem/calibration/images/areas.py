"""Areas of the dark contacts in an image, with their errors."""

from __future__ import annotations

from typing import Any

from metafem._calls import checked_call
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.measuring import measured
from metafem.calibration.images.options import Options


@checked_call
def contact_areas(
    image: Any,
    pixel_size: float,
    *,
    threshold: float | None = None,
    dark_level: float | None = None,
    blur: float | None = None,
    subpixel: bool = True,
    bright_contacts: bool = False,
    smallest_area: float | None = None,
) -> ContactAreas:
    """Measure the areas of the contacts in an image, dark on a brighter ground.

    The image is divided by its ground, a polynomial of degree 2 in x and in y. Contacts are the regions
    within the contour half-way between the grey levels of the ground, 1, and of wide contacts, in the image
    smoothed by a Gaussian as wide as its own blur s, which has the least noise. The blur moves that contour
    inwards by s_t²/2 times its curvature, with s_t² the variance of both. So the contour encloses, for any
    shape, ``pi s_t²`` less than the contact, and this is added, with the next term ``pi s_t⁴/(6 r²)`` of a
    circle.

    Parameters
    ----------
    image : array_like, (rows, columns)
        Grey values, integers or floats; row 0 is the uppermost.
    pixel_size : float
        Side of a pixel [mm].
    threshold : float, optional
        Threshold of `otsu_area`, over the grey level of the ground [-]; default: by Otsu's method.
    dark_level : float, optional
        Grey level of contacts, over that of the ground [-]; default: that of the widest contacts.
    blur : float, optional
        Standard deviation of the edges, that of the optics and of the pixels together [mm]; default: from the
        distance of the quarter levels at the edges of the widest contacts.
    subpixel : bool
        Whether `area` is found with the contour; if not, it is `otsu_area`, and `area_error` contains the
        bias of that; default: True.
    bright_contacts : bool
        Whether contacts are brighter than the ground; default: False.
    smallest_area : float, optional
        Area below which dark regions are left out [mm^2]; default: a circle with the radius 2 s_t.

    Returns
    -------
    ContactAreas

    Raises
    ------
    InvalidInput
        If the image is not one of finite grey values, or shows no contacts.

    Notes
    -----
    The error of an area with the perimeter L is, for noise of standard deviation n of each pixel over the
    contrast, ``n sqrt(2 sqrt(pi) s L)`` square pixels: 0.3, 0.1 and 0.03 % of the area at radii of 10, 20 and
    50 pixels with n = 0.05 and s = 1.5 pixels. To it are added the scatter of the grey levels of ground and
    contacts, and the errors of the dark level and of s, which are common to all contacts of an image.
    Contacts of radius below 2 s_t are not measured, and those below 1.2 s_t do not reach the half level. One
    that comes within 2 s_t of the frame is at its edge. The blur of a neighbour within 2 s_t adds to an area,
    by up to 1 %; nearer ones are merged.

    Otsu's method, IEEE Trans. Syst. Man Cybern. 9, 62 (1979), doi:10.1109/TSMC.1979.4310076, is that of
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234.

    Examples
    --------
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> found = mf.calibration.contact_areas(image, pixel_size=0.005)
    >>> exact = np.pi * (20.0 * 0.005) ** 2
    >>> bool(abs(found.area[0] / exact - 1.0) < 0.01)
    True
    """
    options = Options(pixel_size, threshold, dark_level, blur, subpixel, bright_contacts, smallest_area)
    return measured(image, options)[0]
