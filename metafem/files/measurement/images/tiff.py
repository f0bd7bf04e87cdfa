"""Reading of TIFF files with one or several pages."""

from __future__ import annotations

import logging
import math
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from metafem.errors import InvalidInput
from metafem.files.measurement.images import png
from metafem.files.measurement.images.pages import Damaged, ImageFile, Resolution, damaged, too_large
from metafem.files.units import factor

# Values of the tag PhotometricInterpretation that are read: 0 (white is 0), 1 (black is 0), 2 (colours) and
# 3 (palette).
WHITE_IS_ZERO, PALETTE = 0, 3
READ = (WHITE_IS_ZERO, 1, 2, PALETTE)

# Size of the unit that each value of the tag ResolutionUnit states [mm].
RESOLUTION_UNIT = {2: 25.4, 3: 10.0}

# Exceptions that tifffile raises for damaged files.
FAULTS = (OSError, ValueError, RuntimeError, LookupError, TypeError, struct.error, zlib.error, MemoryError)


def pages(path: Path) -> tuple[list[ImageFile], str]:
    """Return the images in a file, and a text on damage after the last readable page, or ""."""
    with _opened(path) as (file, complaints):
        found = [(index, page) for index, page in enumerate(file.pages) if not page.is_reduced]
        if not found:
            raise Damaged("holds no image")
        resolution = _resolution(file, found[0][1])
        joined = _joined(file, path)
        size = path.stat().st_size
        result = [
            ImageFile(
                path.name,
                path,
                _refused(page, size, number if joined else 1),
                number,
                (int(page.imagelength), int(page.imagewidth)),
                resolution if number == 1 or joined else _resolution(file, page),
                index,
            )
            for number, (index, page) in enumerate(found * joined if joined else found, 1)
        ]
    return result, f"is damaged or cut off after page {len(result)}: {complaints[0]}" if complaints else ""


def read(image: ImageFile) -> NDArray[Any]:
    """Return the values of a page, (rows, columns), or (rows, columns, channels) in colour."""
    with _opened(image.path) as (file, _):
        page = file.pages[image.index]  # reads the tags of this page only
        if _joined(file, image.path):
            # only the first page has tags: the images follow one another in the file
            start = page.dataoffsets[0] + (image.number - 1) * page.nbytes
            kind = page.dtype.newbyteorder(file.byteorder)
            return np.array(np.memmap(image.path, kind, "r", start, page.shape))
        try:
            values = page.asarray()
        except ValueError as error:
            if "imagecodecs" not in str(error):
                raise
            values = None
        photometric, axes = int(page.photometric), page.axes
        palette = page.colormap if photometric == PALETTE else None
    if values is None:
        return png.read(image)  # Pillow reads compressions for which tifffile needs imagecodecs
    if palette is not None:
        values, axes = np.moveaxis(np.asarray(palette)[:, values], 0, -1), "YXS"
    if axes == "SYX":
        values = np.moveaxis(values, 0, -1)
    if photometric == WHITE_IS_ZERO:
        values = -values if values.dtype.kind == "f" else np.iinfo(values.dtype).max - values
    values = np.asarray(values)
    if values.ndim not in (2, 3) or values.shape[:2] != image.shape:
        raise Damaged("cannot be read: it is damaged")
    return values


@contextmanager
def _opened(path: Path) -> Iterator[tuple[Any, list[str]]]:
    """Yield an open file and the list of tifffile's warnings, which are then not logged.

    Raise Damaged for a damaged file.
    """
    import tifffile

    complaints: list[str] = []

    def collected(record: logging.LogRecord) -> bool:
        warns = record.levelno >= logging.WARNING
        if warns:
            complaints.append(record.getMessage().partition("> ")[2] or record.getMessage())
        return not warns

    log = logging.getLogger("tifffile")
    log.addFilter(collected)
    try:
        with tifffile.TiffFile(path) as file:
            len(file.pages)  # finds all pages
            yield file, complaints
    except Damaged:
        raise
    except FAULTS as error:
        raise damaged(error, "not a TIFF", "TIFF file") from None
    finally:
        log.removeFilter(collected)


def _refused(page: Any, size: int, number: int) -> str:
    """Return the reason why a page is not read, or "" if it is read.

    `size` is the size of the file [bytes]. `number` is the number of the image in a stack of which only the
    first page has tags, otherwise 1.
    """
    if page.axes not in ("YX", "YXS", "SYX"):
        return f"has the axes {page.axes}; save pictures of rows and columns"
    if page.dtype is None or page.dtype.kind not in "uif":
        return "is black and white; save it with grey levels"
    if page.axes != "YX" and int(page.samplesperpixel) > 4:
        return f"has {page.samplesperpixel} channels; save the one that shows the contacts"
    if int(page.photometric) not in READ:
        name = getattr(page.photometric, "name", str(page.photometric))
        return f"is stored as {name}; save it with grey levels"
    ends = [at + n for at, n in zip(page.dataoffsets, page.databytecounts, strict=False)]
    if max(ends, default=0) + (number - 1) * page.nbytes > size:
        return "is cut off: the file ends before the last row"
    return too_large(int(page.imagelength), int(page.imagewidth))


def _joined(file: Any, path: Path) -> int:
    """Return the number of images in a stack of which only the first page has tags; 0 for other files."""
    page = file.pages[0]
    if len(file.pages) > 1 or not file.series or not page.is_contiguous or page.axes != "YX":
        return 0
    count = int(math.prod(file.series[0].shape)) // max(math.prod(page.shape), 1)
    if count < 2 or page.dataoffsets[0] + count * page.nbytes > path.stat().st_size:
        return 0
    return int(count)


def _resolution(file: Any, page: Any) -> Resolution | None:
    """Return the size of the pixels that OME, ImageJ or the tags of the page state, or None."""
    if file.is_ome and (stated := _of_ome(file.ome_metadata)) is not None:
        return stated
    tags = [page.tags.get(name) for name in ("XResolution", "YResolution")]
    if any(tag is None for tag in tags):
        return None
    per_unit = [above / below if below else 0.0 for above, below in (tag.value for tag in tags)]
    if min(per_unit) <= 0.0:
        return None
    if file.is_imagej and (name := (file.imagej_metadata or {}).get("unit")):
        size, source = _millimetres(str(name)), "its ImageJ description"
    else:
        unit = page.tags.get("ResolutionUnit")
        size = RESOLUTION_UNIT.get(int(unit.value) if unit is not None else 2)
        source = "its resolution tags"
        if size == RESOLUTION_UNIT[2]:
            source = f"{per_unit[0]:.6g} pixels per inch"
    if size is None:
        return None
    return Resolution(size / per_unit[0], size / per_unit[1], source)


def _millimetres(name: str) -> float | None:
    """Return the size of a unit of length [mm]; None for other units, such as "pixel"."""
    plain = name.strip().strip("\x00").replace("\\u00B5", "µ")
    try:
        return float(factor({"micron": "um", "microns": "um", "inches": "inch"}.get(plain, plain), "mm"))
    except InvalidInput:
        return None


def _of_ome(text: str | None) -> Resolution | None:
    """Return the size of the pixels that OME metadata state, or None."""
    try:
        root = ElementTree.fromstring(text or "")
    except ElementTree.ParseError:
        return None
    pixels = next((element for element in root.iter() if element.tag.endswith("}Pixels")), None)
    if pixels is None:
        return None
    sizes = []
    for axis in "XY":
        value, unit = pixels.get(f"PhysicalSize{axis}"), pixels.get(f"PhysicalSize{axis}Unit", "µm")
        size = _millimetres(unit)
        if value is None or size is None or not float(value) > 0.0:
            return None
        sizes.append(float(value) * size)
    return Resolution(sizes[0], sizes[1], "its OME description")
