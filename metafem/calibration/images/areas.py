"""Measurement of contact areas in one image, or in a series of images with a common threshold."""

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
from metafem.notes import Note
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
    bright_contacts: bool = False,
    smallest_area: float | None = None,
) -> ContactAreas:
    """Return the contacts in an image, dark regions on a brighter ground, with their areas.

    The image is divided by the grey level of its ground, a polynomial of degree 2 in x and in y. It is then
    smoothed by a Gaussian of the same width s as the blur of the image, which gives the least noise in the
    areas. Contacts are the regions within the contour at the half level, half-way between the ground (grey
    level 1) and the dark level of wide contacts. Blur and smoothing have the total variance s_t². They move
    the contour inwards by s_t²/2 times its curvature, so that the contour of any shape encloses ``pi s_t²``
    less than the contact. This area is added, together with the next term for a circle of radius r,
    ``pi s_t⁴/(6 r²)``.

    Parameters
    ----------
    image : array_like, (rows, columns)
        Grey values, integers or floats; row 0 is at the top.
    pixel_size : float
        Side of a pixel [mm].
    threshold : float, optional
        Threshold for `otsu_area`, over the grey level of the ground [-]; default: by Otsu's method.
    dark_level : float, optional
        Grey level of the contacts, over the grey level of the ground [-]; default: measured in the widest
        contacts.
    blur : float, optional
        Standard deviation of the edges, caused by the optics and the pixels [mm]; default: measured from the
        distance between the quarter levels at the edges of the widest contacts.
    bright_contacts : bool
        Whether the contacts are brighter than the ground; default: False.
    smallest_area : float, optional
        Area below which dark regions do not count as contacts [mm^2]; default: a circle of radius 2 s_t.

    Returns
    -------
    ContactAreas

    Raises
    ------
    InvalidInput
        If the image has values that are not finite grey levels, or if it shows no contacts.

    Notes
    -----
    n is the standard deviation of the noise of a pixel over the contrast. If an area has the perimeter L,
    noise causes an error of ``n sqrt(2 sqrt(pi) s L)`` square pixels. For n = 0.05 and s = 1.5 pixels this is
    0.3, 0.1 and 0.03 % of the area at radii of 10, 20 and 50 pixels. `area_error` also includes the scatter
    of the grey levels of the ground and of the contacts, and the errors of the dark level and of s, which are
    common to all contacts of an image. Contacts with a radius below 2 s_t are not measured; below 1.2 s_t
    they do not reach the half level. A contact within 2 s_t of the frame counts as at the edge. The blur of a
    neighbour within 2 s_t enlarges an area by up to 1 %; still closer neighbours are merged.

    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, use Otsu's method: IEEE Trans. Syst.
    Man Cybern. 9, 62 (1979), doi:10.1109/TSMC.1979.4310076.

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
    options = Options(pixel_size, threshold, dark_level, blur, bright_contacts, smallest_area)
    return measured(image, options)[0]


def stack_areas(
    images: Sequence[Any], pixel_size: float, loads: ArrayLike | None = None, **options: Any
) -> tuple[ContactAreas, ...]:
    """Return the contacts in k images, measured with the threshold of the image at the largest load.

    The image at the largest load also determines the dark level and the blur, because narrow contacts at
    smaller loads may not show them. If this image cannot be measured, the image at the next smaller load is
    used instead. If the wide contacts of another image are brighter or darker than the dark level, a note
    says so, and the errors of the areas in that image include the possible effect. A change of the blur
    between images is not detected. The images are read one at a time, from the largest load to the smallest.
    An image that cannot be measured does not stop the others: its result has no contacts, `failed` is true,
    and its notes state the reason.

    Parameters
    ----------
    images : sequence of array_like, (rows, columns)
        Images as for `contact_areas`; the sequence may read an image from a file when ``images[i]`` is
        evaluated.
    pixel_size : float
        Side of a pixel [mm].
    loads : array_like, (k,), optional
        Normal loads [N]; default: the last image is assumed to have the largest load.
    **options
        ``threshold``, ``dark_level``, ``blur``, ``bright_contacts`` and ``smallest_area``, as
        for `contact_areas`.

    Returns
    -------
    tuple of ContactAreas, (k,)
        Contacts of each image, in the order of the images.

    Raises
    ------
    InvalidInput
        If no image can be measured, or if an argument is outside its range.

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
            # every result with these levels has a note that names the source of the levels
            other, _ = next(iter(failures.values()))
            source = "threshold and levels are from {.name}, because {.name} cannot be measured"
            found[i] = replace(found[i], notes=(*found[i].notes, Note(source.format(own, other))))
    if not found:
        first = next(iter(failures.values()))
        raise InvalidInput(f"none of the images can be measured: {NOT_MEASURED}", *first)
    reference = vars(next(iter(found.values())))
    none = {name: value[:0] for name, value in reference.items() if isinstance(value, np.ndarray)}
    for i, failure in failures.items():
        notes = (Note(NOT_MEASURED.format(*failure)),)
        found[i] = ContactAreas(**{**reference, **none, "failed": True, "notes": notes})
    return tuple(found[i] for i in range(count))
