"""Reading of height maps of microscopes with their units."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._extras import refuse_missing
from metafem._given import printable
from metafem.calibration.topography import HeightMap
from metafem.errors import InvalidInput, refuse_if
from metafem.files.disk import file_label, refuse_unreadable
from metafem.files.units import factor, quantity

# Formats that are read: files of instruments and arrays of numpy.
FORMATS = ".x3p, .sur, .plux, .npy and others that SurfaceTopography reads"

# Units of heights that the option --height-unit accepts; both Unicode micro signs are read.
UNITS = ("m", "mm", "um", "µm", "μm", "micron", "nm")

# Number of rows of a map that are converted at a time, to limit the memory.
AT_ONCE = 256

# Warning of SurfaceTopography's import if mpi4py is not installed.
NO_MPI = "Could not import mpi4py"


def read_height_map(path: str | Path, pixel: str | None = None, height_unit: str | None = None) -> HeightMap:
    """Return the height map in a file; the heights are relative to their median, in single precision.

    Parameters
    ----------
    path : str or Path
        File in one of the formats .x3p, .sur, .plux and .npy (rows as in an image), or in another format that
        SurfaceTopography reads.
    pixel : str, optional
        Distance between neighbouring pixels, such as ``"2 um"``, for a file that does not state it.
    height_unit : str, optional
        Unit of the heights, such as ``"um"``, for a file that does not state it.

    Raises
    ------
    InvalidInput
        If the file cannot be read or holds no map, if the pixel or the unit is stated nowhere, or if an
        argument states what the file already states.
    """
    name, kind = file_label(path), Path(path).suffix.lower()
    refuse_unreadable(path)
    if height_unit is not None and height_unit not in UNITS:
        raise InvalidInput(
            f'--height-unit = "{printable(height_unit, 40)}" must be m, mm, um, µm, micron or nm'
        )
    width = None if pixel is None else check.number("--pixel", quantity("--pixel", pixel, "mm"), above=0.0)
    heights, pixels, unit = (_array if kind == ".npy" else _instrument)(path, name)
    lacking = {}
    for option, example, what, stated, given in (
        ("--pixel", '"2 um"', "the size of its pixels", pixels is not None, width),
        ("--height-unit", '"um"', "the unit of its heights", unit is not None, height_unit),
    ):
        refuse_if(stated and given is not None, f"{name} states {what}; leave {option} out")
        if not stated and given is None:
            lacking[what] = f"{option} {example}"
    what, example = " and ".join(lacking), " ".join(lacking.values())
    refuse_if(lacking, f"{name} does not state {what}; add for example {example}")
    try:
        size = float(factor(unit or height_unit or "", "mm"))
    except InvalidInput as error:
        raise InvalidInput(f'--height-unit {error}; write for example "um"') from None
    sides: Any = (width, width) if pixels is None else (pixels[0] * size, pixels[1] * size)
    return HeightMap(_millimetres(heights, size), sides)


# Heights (rows, columns); width and height of a pixel, and the unit of all lengths, None if not stated.
_Read = tuple[NDArray[Any], Any, str | None]


def _array(path: str | Path, name: str) -> _Read:
    """Return the array in an .npy file, which is mapped into memory, so that heights are read on use."""
    try:
        values = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, OSError, EOFError) as error:
        raise InvalidInput(f"{name} is not an array of numpy: {printable(str(error), 200)}") from None
    shape = getattr(values, "shape", "of several arrays")
    wrong = not isinstance(values, np.ndarray) or values.ndim != 2 or values.dtype.kind not in "iuf"
    refuse_if(wrong, f"{name} holds no map: its array {shape} must have rows and columns of heights")
    return values, None, None


def _instrument(path: str | Path, name: str) -> _Read:
    """Return the map in a file of an instrument, which SurfaceTopography reads."""
    refuse_missing("SurfaceTopography", "metrology", f"reading {name}")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", NO_MPI, ImportWarning)
        from SurfaceTopography import IO
    try:
        with IO.open_topography(str(path)) as reader:
            maps = [each for each in reader.channels if each.dim == 2 and each.is_height_channel]
            refuse_if(not maps, f"{name} holds no map of heights")
            channel, sizes = maps[0], maps[0].physical_sizes
            points = channel.nb_grid_pts
            heights = channel.topography(**({} if sizes else {"physical_sizes": points})).heights()
    except (InvalidInput, MemoryError):
        raise
    except Exception as error:  # the readers raise exceptions of all types for damaged files
        kind = type(error).__name__
        raise InvalidInput(
            f"{name} cannot be read as a height map ({FORMATS}): {kind}: {printable(str(error), 200)}"
        ) from None
    unit = channel.unit if isinstance(channel.unit, str) and channel.unit else None
    pixels = (sizes[0] / points[0], sizes[1] / points[1]) if sizes and unit else None
    # in SurfaceTopography the first index runs along x, and the second upwards along y
    return heights.T[::-1], pixels, unit


def _millimetres(heights: NDArray[Any], unit: float) -> NDArray[np.float32]:
    """Return heights relative to their median [mm], in single precision; masked heights are nan."""
    rows, columns = heights.shape
    sample = np.ma.filled(
        heights[:: max(1, rows // 500), :: max(1, columns // 500)].astype(np.float64), np.nan
    )
    finite = sample[np.isfinite(sample)]
    middle = float(np.median(finite)) if finite.size else 0.0
    values = np.empty((rows, columns), dtype=np.float32)
    for start in range(0, rows, AT_ONCE):
        band = slice(start, start + AT_ONCE)
        own = np.ma.filled(np.ma.asarray(heights[band]).astype(np.float64), np.nan)
        values[band] = (own - middle) * unit
    return values
