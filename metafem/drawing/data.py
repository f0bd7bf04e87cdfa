"""The data of a figure as a table: its lines, points, bars, boxes and images."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import StringIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem.drawing import FloatArray, rgba

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

# Largest numbers of points of a series and of values of an image in the table.
MOST_POINTS, MOST_VALUES = 2000, 5000

# Columns of every table, and columns that are present if a series fills them.
ALWAYS = ("panel", "series", "x", "y")
OPTIONAL = ("value", "x_low", "x_high", "y_low", "y_high", "name")

# The five lines of a box plot between one box and the next: whiskers, caps and the median.
BOX_LINES = 6


@dataclass(frozen=True)
class Series:
    """Points of one name, and the data of each: columns of equal length."""

    name: str
    columns: dict[str, FloatArray] = field(default_factory=dict)


def figure_table(figure: Figure) -> str:
    """Return the data of a figure as a CSV table in long form: panel, series, x, y, and a value or errors.

    Lines that begin with # state the axes of each panel with their units, and which data were reduced: long
    series to 2,000 points, images to 5,000 values.
    """
    rows: list[dict[str, str]] = []
    heads = []
    shown = [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]
    for number, ax in enumerate(shown, 1):
        title = " ".join(ax.get_title().split())
        axes = f"x = {_axis_name(ax, 'x')}, y = {_axis_name(ax, 'y')}"
        heads.append(f"# panel {number}{f' ({title})' if title else ''}: {axes}")
        for series in _series(ax):
            count = len(series.columns["x"])
            if count == 0:
                continue
            step = -(-count // MOST_POINTS) if "value" not in series.columns else 1
            if step > 1:
                heads.append(f"# panel {number}, {series.name}: one of {step} of its {count} points")
            rows += _rows(ax, number, series, step)
    columns = [*ALWAYS, *(each for each in OPTIONAL if any(row.get(each) for row in rows))]
    text = StringIO()
    text.write("\n".join(heads) + "\n")
    writer = csv.DictWriter(text, columns, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _axis_name(ax: Axes, along: str) -> str:
    """Return the label of an axis, or that of the panel with which it shares this axis."""
    sharing = (ax.get_shared_x_axes() if along == "x" else ax.get_shared_y_axes()).get_siblings(ax)
    others = [each for each in ax.figure.axes if each in sharing and each is not ax]
    labels = (getattr(each, f"{along}axis").get_label_text() for each in (ax, *others))
    return next((" ".join(label.split()) for label in labels if label.strip()), "not named")


def _by_colour(ax: Axes) -> dict[tuple[float, ...], str]:
    """Return the label of the lines of each colour, of the panel or otherwise of the figure, if unique."""
    found: dict[tuple[float, ...], str] = {}
    for panels in (ax.figure.axes, [ax]):
        labels: dict[tuple[float, ...], set[str]] = {}
        for line in (line for panel in panels for line in panel.lines):
            if name := _named(line, ""):
                labels.setdefault(rgba(line.get_color()), set()).add(name)
        found |= {colour: names.pop() for colour, names in labels.items() if len(names) == 1}
    return found


def _rows(ax: Axes, number: int, series: Series, step: int) -> Iterator[dict[str, str]]:
    """Return the rows of a series."""
    names = {key: _tick_names(axis) for key, axis in (("x", ax.xaxis), ("y", ax.yaxis))}
    printed = {key: [_number(value) for value in each[::step]] for key, each in series.columns.items()}
    for i in range(len(printed["x"])):
        row = {"panel": str(number), "series": series.name, **{key: each[i] for key, each in printed.items()}}
        found = [names[key].get(round(float(row[key]))) for key in ("x", "y") if names[key] and row[key]]
        yield {**row, "name": ", ".join(filter(None, found))}


def _number(value: float) -> str:
    """Return six digits, or "" for a number that is not known."""
    return f"{value:.6g}" if np.isfinite(value) else ""


def _tick_names(axis: Axis) -> dict[int, str]:
    """Return the words at whole positions of an axis that has words in place of numbers."""
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
    """Return the series of one panel."""
    taken: set[int] = set()
    for container in ax.containers:
        kind = type(container).__name__
        if kind == "ErrorbarContainer":
            yield _error_bars(container)
        elif kind == "BarContainer":
            yield _bars(container)
        else:
            continue
        taken |= {id(part) for part in _flat(container)}
    lines = [line for line in ax.lines if id(line) not in taken]
    yield from _lines(ax, lines)
    for number, collection in enumerate((each for each in ax.collections if id(each) not in taken), 1):
        yield from _collection(ax, collection, number)
    for patch in ax.patches:
        if id(patch) not in taken and not str(patch.get_label()).startswith("_"):
            yield from _outline(ax, patch)
    for number, image in enumerate(ax.images, 1):
        yield from _image(image, number)


def _flat(parts: Any) -> Iterator[Any]:
    """Return the artists of a container, whose parts may be tuples."""
    for part in parts:
        if isinstance(part, tuple | list):
            yield from _flat(part)
        elif part is not None:
            yield part


def _named(artist: Any, otherwise: str) -> str:
    """Return the label of an artist, or another name."""
    label = " ".join(str(artist.get_label() or "").split())
    return otherwise if not label or label.startswith("_") else label


def _points(x: ArrayLike, y: ArrayLike, **more: ArrayLike) -> dict[str, FloatArray]:
    """Return columns as flat arrays in which masked numbers are unknown."""
    given = {"x": x, "y": y, **more}
    return {
        key: np.ma.filled(np.ma.asarray(each).astype(float), np.nan).ravel() for key, each in given.items()
    }


def _lines(ax: Axes, lines: list[Any]) -> Iterator[Series]:
    """Return lines and markers; the lines of a box as its five numbers."""
    labels = _by_colour(ax)
    i = number = boxes = 0
    while i < len(lines):
        box = _box(lines[i : i + BOX_LINES])
        if box is not None:
            boxes, i = boxes + 1, i + BOX_LINES
            yield from (Series(f"box {boxes}: {name}", _points([x], [y])) for name, x, y in box)
            continue
        line, i = lines[i], i + 1
        x, y = (np.asarray(each, float) for each in line.get_data(orig=False))
        if not x.size:
            continue
        number += 1
        # a line across the axes, such as a bound, has a position along one of them only
        known = line.get_transform().contains_branch_seperately(ax.transData)
        name = f"line {number}"
        if all(known):
            name = labels.get(rgba(line.get_color()), name)
        else:
            x, y = (
                each[:1] if inside else np.array([np.nan]) for each, inside in zip((x, y), known, strict=True)
            )
        yield Series(_named(line, name), _points(x, y))


def _box(lines: list[Any]) -> list[tuple[str, float, float]] | None:
    """Return names, positions and values of the numbers of a box plot; None if the lines are not one."""
    if len(lines) < BOX_LINES or any(not str(line.get_label()).startswith("_") for line in lines):
        return None
    data = [np.column_stack(line.get_data(orig=False)).astype(float) for line in lines]
    corners, low, high, _, _, median = data
    if len(corners) != 5 or [len(each) for each in data[1:]] != [2] * 5 or (corners[0] != corners[-1]).any():
        return None
    x = float(corners[:4, 0].mean())
    values = (low[:, 1].min(), corners[:, 1].min(), median[0, 1], corners[:, 1].max(), high[:, 1].max())
    names = ("lower whisker", "lower quartile", "median", "upper quartile", "upper whisker")
    return [(name, x, float(value)) for name, value in zip(names, values, strict=True)]


def _error_bars(container: Any) -> Series:
    """Return points with the ends of their error bars."""
    line, _, bars = container.lines
    ends = [np.array(each.get_segments(), float) for each in bars]
    columns: dict[str, FloatArray] = {}
    for segments in ends:
        if len(segments):
            along = "x" if np.ptp(segments[:, :, 1], axis=1).max() == 0.0 else "y"
            values = segments[:, :, 0 if along == "x" else 1]
            columns |= {f"{along}_low": values.min(axis=1), f"{along}_high": values.max(axis=1)}
    if line is not None:
        x, y = line.get_data(orig=False)
    else:
        middle = ends[0].mean(axis=1)
        x, y = middle.T
    points = _points(x, y)
    kept = {key: each for key, each in columns.items() if len(each) == len(points["x"])}
    return Series(_named(container, "error bars"), {**points, **kept})


def _bars(container: Any) -> Series:
    """Return the middles and the lengths of bars."""
    across = container.orientation == "horizontal"
    place = [
        bar.get_y() + 0.5 * bar.get_height() if across else bar.get_x() + 0.5 * bar.get_width()
        for bar in container.patches
    ]
    size = [bar.get_width() if across else bar.get_height() for bar in container.patches]
    return Series(_named(container, "bars"), _points(size, place) if across else _points(place, size))


def _collection(ax: Axes, collection: Any, number: int) -> Iterator[Series]:
    """Return the points of a scatter, the corners of a filled area, a mesh, lines or contours."""
    kind, name = type(collection).__name__, _named(collection, f"points {number}")
    if kind == "QuadMesh":
        corners = np.asarray(collection.get_coordinates(), float)
        middle = 0.25 * (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:])
        value = np.ma.asarray(collection.get_array()).reshape(middle.shape[:2])
        yield _field(_named(collection, "mesh"), middle[..., 0], middle[..., 1], value)
    elif hasattr(collection, "allsegs"):
        for level, segments in zip(collection.levels, collection.allsegs, strict=False):
            for each in segments:
                if len(each):
                    yield Series(f"contour {_number(level)}", _points(*np.asarray(each).T))
    elif kind == "LineCollection" or "Poly" in kind:
        for each in collection.get_paths():
            yield Series(_named(collection, f"outline {number}"), _points(*each.vertices.T))
    else:
        x, y = np.ma.asarray(collection.get_offsets()).T
        value = collection.get_array()
        more = {"value": value} if value is not None and len(value) == len(x) else {}
        yield Series(name, _points(x, y, **more))


def _outline(ax: Axes, patch: Any) -> Iterator[Series]:
    """Return the corners of a labelled shape in the units of the axes."""
    known = patch.get_data_transform().contains_branch_seperately(ax.transData)
    corners = patch.get_patch_transform().transform(patch.get_path().vertices)
    x, y = (
        each if inside else np.full(len(each), np.nan) for each, inside in zip(corners.T, known, strict=True)
    )
    yield Series(_named(patch, "shape"), _points(x, y))


def _image(image: Any, number: int) -> Iterator[Series]:
    """Return the values of an image with the middles of its pixels; a colour image has no values."""
    value = np.ma.asarray(image.get_array())
    if value.ndim == 2:
        left, right, bottom, top = image.get_extent()
        rows, columns = value.shape
        x = left + (np.arange(columns) + 0.5) * (right - left) / columns
        y = bottom + (np.arange(rows) + 0.5) * (top - bottom) / rows
        y = y if image.origin == "lower" else y[::-1]
        across, up = np.meshgrid(x, y)
        yield _field(_named(image, f"image {number}"), across, up, value)


def _field(name: str, x: FloatArray, y: FloatArray, value: Any) -> Series:
    """Return values on a grid; of a large one, every n-th row and column, as stated in the name."""
    step = int(np.ceil(np.sqrt(value.size / MOST_VALUES)))
    if step > 1:
        name = f"{name} (one of {step} rows and columns)"
    return Series(name, _points(*(each[::step, ::step] for each in (x, y)), value=value[::step, ::step]))
