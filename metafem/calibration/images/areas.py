"""Areas of the dark contacts in an image, or in a series of images with one threshold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._given import Given, shown
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.grey import Options
from metafem.calibration.images.levels import Levels
from metafem.calibration.images.measuring import measured
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import ArgumentNote
from metafem.progress import each

# Note on an image that cannot be measured.
NOT_MEASURED = "{.name} is not measured: {.number}"


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

    The image is divided by its ground, a polynomial of degree 2 in x and in y. The image is then smoothed by
    a Gaussian as wide as its own blur s, which gives the least noise. Contacts are the regions within the
    contour half-way between the grey levels of the ground, 1, and of wide contacts. Blur and smoothing, with
    the total variance s_t², move this contour inwards by s_t²/2 times its curvature. For any shape it
    therefore encloses ``pi s_t²`` less than the contact. This is added, with the next term ``pi s_t⁴/(6 r²)``
    of a circle.

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
        Standard deviation of the edges, from the optics and the pixels together [mm]; default: from the
        distance of the quarter levels at the edges of the widest contacts.
    subpixel : bool
        Whether `area` is found with the contour; if not, it is `otsu_area`, and `area_error` includes its
        bias; default: True.
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
        If the image has values that are not finite grey levels, or shows no contacts.

    Notes
    -----
    The error of an area with the perimeter L is, for noise of standard deviation n of each pixel over the
    contrast, ``n sqrt(2 sqrt(pi) s L)`` square pixels: 0.3, 0.1 and 0.03 % of the area at radii of 10, 20 and
    50 pixels with n = 0.05 and s = 1.5 pixels. The scatter of the grey levels of ground and contacts is
    added, and so are the errors of the dark level and of s, which are common to all contacts of an image.
    Contacts of radius below 2 s_t are not measured, and those below 1.2 s_t do not reach the half level. A
    contact within 2 s_t of the frame is at its edge. The blur of a neighbour within 2 s_t adds to an area, by
    up to 1 %; nearer ones are merged.

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


def stack_areas(
    images: Sequence[Any], pixel_size: float, loads: ArrayLike | None = None, **options: Any
) -> tuple[ContactAreas, ...]:
    """Measure the areas of the contacts in k images with the threshold of the image at the largest load.

    That image also supplies the dark level and the blur, as the contacts at smaller loads may be too narrow
    to show them. If it cannot be measured, the image at the next smaller load is used. If the wide contacts
    of another image are brighter or darker than that level, a note says so, and the errors of its areas
    include the possible effect; a change of the blur between images is not noticed. The images are read one
    at a time, from the largest load to the smallest. If an image cannot be measured, the others still are:
    its result has no contacts, `failed` is true, and its notes state the reason.

    Parameters
    ----------
    images : sequence of array_like, (rows, columns)
        Grey values, as for `contact_areas`; ``images[i]`` may read an image from a file.
    pixel_size : float
        Side of a pixel [mm].
    loads : array_like, (k,), optional
        Normal loads [N]; default: the last image has the largest.
    **options
        ``threshold``, ``dark_level``, ``blur``, ``subpixel``, ``bright_contacts`` and ``smallest_area``, as
        for `contact_areas`.

    Returns
    -------
    tuple of ContactAreas, (k,)
        In the order of the images.

    Raises
    ------
    InvalidInput
        If no image can be measured, or an argument is outside its range.

    Examples
    --------
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> images = [200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - r)) for r in (8.0, 14.0, 20.0)]
    >>> found = mf.calibration.stack_areas([np.zeros((60, 80)), *images], 0.005, loads=[0.0, 0.1, 0.2, 0.3])
    >>> [areas.count for areas in found], found[0].failed, len({areas.threshold for areas in found})
    ([0, 1, 1, 1], True, 1)
    """
    given = Options(pixel_size, **options)
    try:
        count = len(images)
    except TypeError:
        raise InvalidInput(f"images = {shown(images)} must be a sequence of images") from None
    refuse_if(not count, "images is empty; it must hold at least one image")
    load = np.arange(count) if loads is None else check.array("loads", loads, shape=(count,))
    found: dict[int, ContactAreas] = {}
    failures: dict[int, tuple[Given, Given]] = {}
    levels: Levels | None = None
    for i in each("measuring image", np.argsort(-load, kind="stable").tolist()):
        own = Given(f"images[{i}]")
        try:
            found[i], levels = measured(images[i], given, levels)
        except InvalidInput as error:
            failures[i] = own, Given("reason", str(error))
            continue
        if len(found) == 1 and failures:
            # each result with these levels has a note on their source
            other, _ = next(iter(failures.values()))
            source = "threshold and levels are from {.name}, because {.name} cannot be measured"
            found[i] = replace(found[i], notes=(*found[i].notes, ArgumentNote.of(source, own, other)))
    if not found:
        first = next(iter(failures.values()))
        raise InvalidInput(f"none of the images can be measured: {NOT_MEASURED}", *first)
    reference = vars(next(iter(found.values())))
    none = {name: value[:0] for name, value in reference.items() if isinstance(value, np.ndarray)}
    for i, failure in failures.items():
        notes = (ArgumentNote.of(NOT_MEASURED, *failure),)
        found[i] = ContactAreas(**{**reference, **none, "failed": True, "notes": notes})
    return tuple(found[i] for i in range(count))
