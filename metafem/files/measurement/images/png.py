"""Reading of PNG files."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem.files.measurement.images.pages import Damaged, ImageFile, Resolution, damaged, too_large

# Modes of Pillow with grey levels, and modes that are converted to colours or grey levels.
GREY = {"L", "I", "F", "I;16", "I;16B", "I;16L", "I;16N"}
CONVERTED = {"P": "RGB", "PA": "RGB", "RGBA": "RGB", "RGBX": "RGB", "LA": "L", "La": "L", "RGB": "RGB"}

MILLIMETRES_PER_INCH = 25.4


def pages(path: Path) -> tuple[list[ImageFile], str]:
    """Return the single image of a file, and "" because no page can be damaged."""
    with opened(path) as image:
        columns, rows = image.size
        broken = _refused(image.mode) or too_large(rows, columns)
        return [ImageFile(path.name, path, broken, 1, (rows, columns), _resolution(image))], ""


def read(file: ImageFile) -> NDArray[Any]:
    """Return the values of an image, (rows, columns), or (rows, columns, 3) in colour."""
    with opened(file.path) as image:
        if file.number > 1:
            image.seek(file.number - 1)
        if image.mode in CONVERTED:
            image = image.convert(CONVERTED[image.mode])
        return np.array(image)


def _refused(mode: str) -> str:
    """Return the reason why an image with this mode is not read, or "" if it is read."""
    if mode in GREY or mode in CONVERTED:
        return ""
    kind = "black and white" if mode == "1" else f"of the kind {mode}"
    return f"is {kind}; save it with grey levels"


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Yield an open image; raise Damaged if the file is not an image or is incomplete."""
    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a warning on large images: their size is checked elsewhere
            with Image.open(path) as image:
                yield image
    except Damaged:
        raise
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
        raise damaged(error, "identify", "image") from None


def _resolution(image: Any) -> Resolution | None:
    """Return the size of the pixels that the file states, or None."""
    given = image.info.get("dpi")
    if not given or min(given) <= 0.0:
        return None
    x, y = (MILLIMETRES_PER_INCH / float(dpi) for dpi in given)
    return Resolution(x, y, f"{float(given[0]):.6g} pixels per inch")
