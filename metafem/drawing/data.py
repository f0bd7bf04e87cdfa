"""The data of a figure as a table: its lines, points, bars and images."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from io import StringIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem.drawing import FloatArray, rgba

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

# Largest number of points of a series, and largest number of values of an image, in the table.
MOST_POINTS, MOST_VALUES = 2000, 5000

# Columns of every table, and columns that a table has only if a series fills them.
ALWAYS = ("panel", "series", "x", "y")
OPTIONAL = ("value", "x_low", "x_high", "y_low", "y_high", "name")

# The name of a series, and its data: columns of equal length.
Series = tuple[str, dict[str, FloatArray]]

# Prefixes of the labels that matplotlib itself sets. Any other label is a name, even if no legend shows it.
NAMELESS = ("_child", "_container", "_nolegend")


def figure_table(figure: Figure) -> str:
    """Return the data of a figure as a CSV table in long form: panel, series, x, y, and a value or errors.

    Lines that begin with # state the axes of each panel with their units, and which series were reduced. A
    series has at most 2,000 points, and an image about 5,000 values.
    """
    rows: list[dict[str, str]] = []
    heads = []
    shown = [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]
    for number, ax in enumerate(shown, 1):
        title = " ".join(ax.get_title().split())
        axes = f"x = {_axis_name(ax, 'x')}, y = {_axis_name(ax, 'y')}"
        heads.append(f"# panel {number}{f' ({title})' if title else ''}: {axes}")
        for name, columns in _series(ax):
            count = len(columns["x"])
            step = max(1, -(-count // MOST_POINTS)) if "value" not in columns else 1
            if step > 1:
                heads.append(f"# panel {number}, {name}: one of {step} of its {count} points")
            thinned = {key: each[::step] for key, each in columns.items()}
            rows += ({"panel": str(number), "series": name, **row} for row in _rows(ax, thinned))
    filled = [*ALWAYS, *(each for each in OPTIONAL if any(row.get(each) for row in rows))]
    text = StringIO()
    text.write("\n".join(heads) + "\n")
    writer = csv.DictWriter(text, filled, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _axis_name(ax: Axes, along: str) -> str:
    """Return the label of an axis, or the label on another panel that shares this axis."""
    sharing = (ax.get_shared_x_axes() if along == "x" else ax.get_shared_y_axes()).get_siblings(ax)
    others = [each for each in ax.figure.axes if each in sharing and each is not ax]
    labels = (getattr(each, f"{along}axis").get_label_text() for each in (ax, *others))
    return next((" ".join(label.split()) for label in labels if label.strip()), "not named")


def _by_colour(ax: Axes) -> dict[tuple[float, ...], str]:
    """Return the label of each line colour that has only one label in the panel, or else in the figure."""
    found: dict[tuple[float, ...], str] = {}
    for panels in (ax.figure.axes, [ax]):
        labels: dict[tuple[float, ...], set[str]] = {}
        for line in (line for panel in panels for line in panel.lines):
            if name := _named(line, ""):
                labels.setdefault(rgba(line.get_color()), set()).add(name)
        found |= {colour: names.pop() for colour, names in labels.items() if len(names) == 1}
    return found


def _rows(ax: Axes, columns: dict[str, FloatArray]) -> Iterator[dict[str, str]]:
    """Yield the rows of a series, with the tick names at the positions of the points."""
    names = [(key, _tick_names(axis)) for key, axis in (("x", ax.xaxis), ("y", ax.yaxis))]
    for values in zip(*columns.values(), strict=True):
        row = {key: _number(value) for key, value in zip(columns, values, strict=True)}
        found = (words.get(round(float(row[key]))) for key, words in names if words and row[key])
        yield {**row, "name": ", ".join(filter(None, found))}


def _number(value: float) -> str:
    """Return a number with six digits, or "" if it is nan or infinite."""
    return f"{value:.6g}" if np.isfinite(value) else ""


def _tick_names(axis: Axis) -> dict[int, str]:
    """Return the tick names of an axis with words instead of numbers, by their rounded positions."""
    formatter = type(axis.get_major_formatter()).__name__
    if formatter not in ("FixedFormatter", "FuncFormatter", "StrCategoryFormatter"):
        return {}
    places = np.asarray(axis.get_ticklocs(), float)
    words = axis.get_major_formatter().format_ticks(places.tolist())
    return {
        round(float(place)): " ".join(each.split())
        for place, each in zip(places, words, strict=True)
        if any(letter.isalpha() for letter in each)
    }


def _series(ax: Axes) -> Iterator[Series]:
    """Yield the series of one panel."""
    taken: set[int] = set()
    readers = {"ErrorbarContainer": _error_bars, "BarContainer": _bars}
    for container in ax.containers:
        if read := readers.get(type(container).__name__):
            yield read(container)
            taken |= set(map(id, container.get_children()))
    kinds: tuple[Any, ...] = ax.lines, ax.collections, ax.patches
    lines, collections, patches = ([each for each in kind if id(each) not in taken] for kind in kinds)
    yield from _lines(ax, lines)
    for number, collection in enumerate(collections, 1):
        yield from _collection(collection, number)
    for patch in patches:
        if not str(patch.get_label()).startswith("_"):
            corners = patch.get_patch_transform().transform(patch.get_path().vertices)
            known = patch.get_data_transform().contains_branch_seperately(ax.transData)
            yield _named(patch, "shape"), _points(*np.where(known, corners, np.nan).T)
    for number, image in enumerate(ax.images, 1):
        value: Any = np.ma.asarray(image.get_array())
        if value.ndim == 2:  # a colour image has no single value at a pixel
            left, right, bottom, top = image.get_extent()
            across, up = ((np.arange(size) + 0.5) / size for size in value.shape[::-1])
            y = bottom + (up if image.origin == "lower" else up[::-1]) * (top - bottom)
            yield _field(_named(image, f"image {number}"), left + across * (right - left), y[:, None], value)


def _named(artist: Any, otherwise: str) -> str:
    """Return the label of an artist, or the name `otherwise` if the artist has no label."""
    label = " ".join(str(artist.get_label() or "").split())
    return otherwise if label.startswith(NAMELESS) else label.removeprefix("_") or otherwise


def _points(x: ArrayLike, y: ArrayLike, **more: ArrayLike) -> dict[str, FloatArray]:
    """Return columns as flat arrays, with nan for masked numbers."""
    given = {"x": x, "y": y, **more}
    return {
        key: np.ma.filled(np.ma.asarray(each).astype(float), np.nan).ravel() for key, each in given.items()
    }


def _lines(ax: Axes, lines: Sequence[Any]) -> Iterator[Series]:
    """Yield the series of lines and markers."""
    labels = _by_colour(ax)
    shown = [line for line in lines if np.size(line.get_xdata(orig=False))]
    for number, line in enumerate(shown, 1):
        points = _points(*line.get_data(orig=False))
        # a line across the panel, such as a bound, has data coordinates along one axis only
        known = dict(zip("xy", line.get_transform().contains_branch_seperately(ax.transData), strict=True))
        name = f"line {number}"
        if all(known.values()):
            name = labels.get(rgba(line.get_color()), name)
        else:
            points = {key: each[:1] if known[key] else np.array([np.nan]) for key, each in points.items()}
        yield _named(line, name), points


def _error_bars(container: Any) -> Series:
    """Return the series of points with the ends of their error bars."""
    line, _, bars = container.lines
    segments = [np.array(each.get_segments(), float) for each in bars]
    x, y = segments[0].mean(axis=1).T if line is None else line.get_data(orig=False)
    points = _points(x, y)
    for ends in segments:
        if len(ends) == len(points["x"]) > 0:
            along = "x" if np.ptp(ends[:, :, 1], axis=1).max() == 0.0 else "y"
            values = ends[:, :, "xy".index(along)]
            points |= {f"{along}_low": values.min(axis=1), f"{along}_high": values.max(axis=1)}
    return _named(container, "error bars"), points


def _bars(container: Any) -> Series:
    """Return the series of the centres and the lengths of bars."""
    boxes = np.array([[*bar.get_xy(), bar.get_width(), bar.get_height()] for bar in container.patches])
    x, y, width, height = boxes.reshape(-1, 4).T
    across = container.orientation == "horizontal"
    points = _points(width, y + 0.5 * height) if across else _points(x + 0.5 * width, height)
    return _named(container, "bars"), points


def _collection(collection: Any, number: int) -> Iterator[Series]:
    """Yield the points of a scatter plot, the cells of a mesh, or the corners of filled areas or lines."""
    kind, value = type(collection).__name__, collection.get_array()
    if kind == "QuadMesh":
        corners = np.asarray(collection.get_coordinates(), float)
        x, y = np.moveaxis(
            0.25 * (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:]), -1, 0
        )
        yield _field(_named(collection, "mesh"), x, y, np.ma.asarray(value).reshape(x.shape))
    elif kind == "LineCollection" or "Poly" in kind:
        for each in collection.get_paths():
            yield _named(collection, f"outline {number}"), _points(*each.vertices.T)
    else:
        x, y = np.ma.asarray(collection.get_offsets()).T
        more = {"value": value} if value is not None and len(value) == len(x) else {}
        yield _named(collection, f"points {number}"), _points(x, y, **more)


def _field(name: str, x: FloatArray, y: FloatArray, value: Any) -> Series:
    """Return values on a grid as a series; of a large grid, only every n-th row and column."""
    step = int(np.ceil(np.sqrt(value.size / MOST_VALUES)))
    if step > 1:
        name = f"{name} (one of {step} rows and columns)"
    x, y = (np.broadcast_to(each, value.shape)[::step, ::step] for each in (x, y))
    return name, _points(x, y, value=value[::step, ::step])
