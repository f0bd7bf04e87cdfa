"""Areas of the contacts in a series of images, with one threshold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_call
from metafem._given import shown
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.levels import Levels
from metafem.calibration.images.measuring import measured
from metafem.calibration.images.options import Options
from metafem.errors import InvalidInput
from metafem.notes import Note
from metafem.progress import each


@checked_call
def stack_areas(
    images: Sequence[Any],
    pixel_size: float,
    loads: ArrayLike | None = None,
    *,
    threshold: float | None = None,
    dark_level: float | None = None,
    blur: float | None = None,
    subpixel: bool = True,
    bright_contacts: bool = False,
    smallest_area: float | None = None,
) -> tuple[ContactAreas, ...]:
    """Measure the areas of the contacts in k images with the threshold of the image at the largest load.

    That image also supplies the dark level and the blur, as the contacts at smaller loads may be too narrow
    to show them. If it cannot be measured, the one at the next smaller load takes its place. Where the wide
    contacts of another image are brighter or darker than that level, a note says so, and the errors of its
    areas contain what this may cause; a change of the blur between images is not noticed. The images are read
    one at a time, from the largest load to the smallest. One that cannot be measured does not stop the
    others: its result has no contacts, `failed` is true, and its notes say why.

    Parameters
    ----------
    images : sequence of array_like, (rows, columns)
        Grey values, as for `contact_areas`; ``images[i]`` may read an image from a file.
    pixel_size : float
        Side of a pixel [mm].
    loads : array_like, (k,), optional
        Normal loads [N]; default: the last image has the largest.
    threshold, dark_level, blur, subpixel, bright_contacts, smallest_area
        As for `contact_areas`.

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
    options = Options(pixel_size, threshold, dark_level, blur, subpixel, bright_contacts, smallest_area)
    try:
        count = len(images)
    except TypeError:
        raise InvalidInput(f"images = {shown(images)} must be a sequence of images") from None
    if not count:
        raise InvalidInput("images is empty; it must hold at least one image")
    load = np.arange(count) if loads is None else check.array("loads", loads, shape=(count,))
    found: dict[int, ContactAreas] = {}
    failures: dict[int, str] = {}
    levels: Levels | None = None
    for i in each("measuring image", np.argsort(-load, kind="stable").tolist()):
        try:
            found[i], levels = measured(images[i], options, levels)
        except InvalidInput as error:
            failures[i] = str(error)
            continue
        if len(found) == 1 and failures:
            # every result with these levels says where they are from
            other = next(iter(failures))
            first = Note(
                f"threshold and levels are from images[{i}], because images[{other}] cannot be measured"
            )
            found[i] = replace(found[i], notes=(*found[i].notes, first))
    if not found:
        raise InvalidInput(f"none of the images can be measured: {_failed(failures)}")
    reference = next(iter(found.values()))
    empty = {i: _none(reference, f"images[{i}] is not measured: {text}") for i, text in failures.items()}
    return tuple(found[i] if i in found else empty[i] for i in range(count))


def _failed(failures: dict[int, str]) -> str:
    """Return the first image that was not measured, and why."""
    i, text = next(iter(failures.items()))
    return f"images[{i}] is not measured: {text}"


def _none(reference: ContactAreas, why: str) -> ContactAreas:
    """Return the result of an image that is not measured: no contacts."""
    none = {
        name: getattr(reference, name)[:0]
        for name in (
            *("area", "area_error", "otsu_area", "centre", "axes", "angle"),
            *("edge", "merged", "saturated", "holes"),
        )
    }
    return replace(reference, **none, failed=True, notes=(Note(why),))
