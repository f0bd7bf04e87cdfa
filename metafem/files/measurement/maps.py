"""Height maps of microscopes, read with their units."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._extras import refuse_missing
from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.reading import file_label, refuse_unreadable
from metafem.files.units import factor, quantity

# Formats that are read: the map of an instrument, an array of numpy, and a list of points.
FORMATS = ".x3p, .sur, .plux, .npy, .xyz and others that SurfaceTopography reads"

# Units of heights that an option names; both micro signs are read.
UNITS = ("m", "mm", "um", "µm", "μm", "micron", "nm")

# Number of rows of a large map that are converted at once.
AT_ONCE = 256

# Points of a list must lie on a grid to this fraction of a pixel: the rounding of their coordinates.
ON_GRID = 0.1

# Largest number of pixels per point of a list; pixels without a point are holes.
SPARSE = 10

# The warning of SurfaceTopography's import where no mpi4py is installed.
NO_MPI = "Could not import mpi4py"


@dataclass(frozen=True, eq=False)
class StoredMap:
    """Heights (rows, columns) [mm] relative to their median, and width and height of a pixel [mm].

    Heights are nan where not measured. Columns run along x, rows downwards along -y.
    """

    values: NDArray[np.float32]
    pixel: tuple[float, float]


def read_height_map(path: str | Path, pixel: str | None = None, height_unit: str | None = None) -> StoredMap:
    """Return the map of a file.

    Parameters
    ----------
    path : str or Path
        In one of the formats .x3p, .sur, .plux, .npy (rows as in an image), .xyz (lines x y z), or another
        one that SurfaceTopography reads.
    pixel : str, optional
        Distance of neighbouring pixels, such as ``"2 um"``, for a file that does not state it.
    height_unit : str, optional
        Unit of the heights, such as ``"um"``, for a file that does not state it.

    Raises
    ------
    InvalidInput
        For a file that cannot be read or holds no map; if the pixel or the unit is missing, or is given
        although the file states it.
    """
    name, kind = file_label(path), Path(path).suffix.lower()
    refuse_unreadable(path)
    if height_unit is not None and height_unit not in UNITS:
        raise InvalidInput(
            f'--height-unit = "{printable(height_unit, 40)}" must be m, mm, um, µm, micron or nm'
        )
    size = None if height_unit is None else _unit_size(height_unit)
    width = None if pixel is None else _pixel_size(pixel)
    if kind in (".npy", ".xyz"):
        if width is None or size is None:
            missing = [
                text
                for text, value in (('--pixel "2 um"', width), ('--height-unit "um"', size))
                if value is None
            ]
            raise InvalidInput(f"{name} states no units; add for example {' '.join(missing)}")
        heights, pixels = (_array(path, name), 1.0) if kind == ".npy" else _points(path, name)
        return StoredMap(_millimetres(heights, size), (width, width * pixels))
    return _instrument(path, name, width, size)


def _unit_size(unit: str) -> float:
    try:
        return float(factor(unit, "mm"))
    except InvalidInput as error:
        raise InvalidInput(f'--height-unit {error}; write for example "um"') from None


def _pixel_size(pixel: str) -> float:
    size = quantity("--pixel", pixel, "mm", "2 um")
    if not size > 0.0:
        raise InvalidInput(f"--pixel = {printable(pixel, 40)} must be greater than 0")
    return size


def _array(path: str | Path, name: str) -> NDArray[Any]:
    """Return the array of an .npy file; its heights are read when they are used."""
    try:
        values = np.load(path, mmap_mode="r", allow_pickle=False)
    except (ValueError, OSError, EOFError) as error:
        raise InvalidInput(f"{name} is not an array of numpy: {printable(str(error), 200)}") from None
    if not isinstance(values, np.ndarray) or values.ndim != 2 or values.dtype.kind not in "iuf":
        shape = getattr(values, "shape", "of several arrays")
        raise InvalidInput(f"{name} holds no map: its array {shape} must have rows and columns of heights")
    return values


def _points(path: str | Path, name: str) -> tuple[NDArray[Any], float]:
    """Return the heights of a list of points x y z on a grid, and the height of a pixel over its width."""
    import pandas

    first = _first_line(path, name)
    separator = next((sign for sign in ";,\t" if sign in first), r"\s+")
    try:
        table = pandas.read_csv(
            path, sep=separator, header=None, comment="#", dtype=np.float64, skip_blank_lines=True,
            skipinitialspace=True, na_values=["NaN", "***"],
        )  # fmt: skip
    except (ValueError, pandas.errors.ParserError) as error:
        raise InvalidInput(f"{name} is not a list of points x y z: {printable(str(error), 200)}") from None
    if table.shape[1] != 3 or not len(table):
        raise InvalidInput(f"{name} has {table.shape[1]} columns; a list of points has three, x y z")
    x, y, z = table.to_numpy().T
    bad = np.flatnonzero(~(np.isfinite(x) & np.isfinite(y)))
    if bad.size:
        raise InvalidInput(f"{name}: point {bad[0] + 1} has no finite x and y")
    column, dx = _grid(x, "x", name)
    row, dy = _grid(y, "y", name)
    shape = int(row.max()) + 1, int(column.max()) + 1
    if shape[0] * shape[1] > SPARSE * len(z):
        raise InvalidInput(
            f"{name}: its {len(z)} points are not on a grid; {shape[1]} x {shape[0]} pixels would hold them"
        )
    heights = np.full(shape, np.nan)
    heights[shape[0] - 1 - row, column] = z
    return heights, dy / dx


def _first_line(path: str | Path, name: str) -> str:
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                return line
    raise InvalidInput(f"{name} holds no points")


def _grid(values: NDArray[Any], axis: str, name: str) -> tuple[NDArray[np.intp], float]:
    """Return the places of coordinates on an equidistant grid, and its step."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > 1e-6 * np.ptp(values)]  # coordinates may differ in their last digits
    if not steps.size:
        raise InvalidInput(f"{name}: all points have the same {axis}; a map has rows and columns")
    number = np.rint(np.ptp(values) / np.median(steps))
    step = float(np.ptp(values) / number)
    place = (values - values.min()) / step
    off = np.abs(place - np.rint(place))
    if off.max() > ON_GRID:
        i = int(off.argmax())
        raise InvalidInput(
            f"{name}: point {i + 1}, {axis} = {values[i]:g}, is not on the grid with steps of {step:g}"
        )
    return np.rint(place).astype(np.intp), step


def _instrument(path: str | Path, name: str, width: float | None, size: float | None) -> StoredMap:
    """Return the map of a file of an instrument."""
    refuse_missing("SurfaceTopography", "metrology", f"reading {name}")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", NO_MPI, ImportWarning)
        from SurfaceTopography import IO
    try:
        with IO.open_topography(str(path)) as reader:
            channel = _channel(reader, name)
            stated = channel.unit if isinstance(channel.unit, str) else None
            lengths = channel.physical_sizes if channel.physical_sizes and stated else None
            _refuse_twice_or_missing(name, (lengths, width), (stated, size))
            points = channel.nb_grid_pts
            options = {} if channel.physical_sizes else {"physical_sizes": points}
            heights = channel.topography(**options).heights()
    except (InvalidInput, MemoryError):
        raise
    except Exception as error:  # for damaged files the readers raise any exception
        kind = type(error).__name__
        raise InvalidInput(
            f"{name} cannot be read as a height map ({FORMATS}): {kind}: {printable(str(error), 200)}"
        ) from None
    unit = _unit_size(stated) if stated else size
    assert unit is not None
    if lengths:
        pixel = lengths[0] / points[0] * unit, lengths[1] / points[1] * unit
    else:
        assert width is not None
        pixel = width, width
    # the first index runs along x, the second upwards along y
    return StoredMap(_millimetres(heights.T[::-1], unit), pixel)


def _channel(reader: Any, name: str) -> Any:
    """Return the first map of heights of a file."""
    maps = [each for each in reader.channels if each.dim == 2 and each.is_height_channel]
    if not maps:
        raise InvalidInput(f"{name} holds no map of heights")
    return maps[0]


def _refuse_twice_or_missing(name: str, width: tuple[Any, Any], unit: tuple[Any, Any]) -> None:
    for option, example, (stated, given), what in (
        ("--pixel", '"2 um"', width, "the size of its pixels"),
        ("--height-unit", '"um"', unit, "the unit of its heights"),
    ):
        if stated is not None and given is not None:
            raise InvalidInput(f"{name} states {what}; leave {option} out")
        if stated is None and given is None:
            raise InvalidInput(f"{name} does not state {what}; add for example {option} {example}")


def _millimetres(heights: NDArray[Any], unit: float) -> NDArray[np.float32]:
    """Return heights in mm relative to their median, in single precision; masked ones are nan."""
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
