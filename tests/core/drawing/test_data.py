"""The table of a figure against what was drawn."""

import csv

import numpy as np
import pytest

from metafem.drawing import new_figure
from metafem.drawing.data import MOST_POINTS, MOST_VALUES, figure_table


@pytest.fixture
def ax():
    return new_figure(5.0, 4.0).add_subplot()


def table(ax):
    """Comments and rows of the table."""
    lines = figure_table(ax.figure).splitlines()
    heads = [line for line in lines if line.startswith("#")]
    return heads, list(csv.DictReader(lines[len(heads) :]))


def column(rows, name):
    return [float(row[name]) if row[name] else None for row in rows]


def test_lines_and_axes(ax):
    ax.plot([1.0, 2.0, 3.0], [4.0, np.nan, 6.0], label="_achieved,\nmean")
    ax.axhline(2.3)
    ax.set(xlabel="load  P [N]", title="A")
    heads, rows = table(ax)
    assert heads == ["# panel 1 (A): x = load P [N], y = not named"]
    assert list(rows[0]) == ["panel", "series", "x", "y"]
    assert [row["series"] for row in rows] == ["achieved, mean"] * 3 + ["line 2"]
    assert column(rows, "x") == [1.0, 2.0, 3.0, None]  # the bound lies at no place along x
    assert column(rows, "y") == [4.0, None, 6.0, 2.3]


def test_error_bars_and_bars(ax):
    ax.errorbar([1.0, 2.0], [3.0, 4.0], [[0.1, 0.2], [0.3, 0.4]], 0.1, fmt="o", capsize=2, label="m")
    ax.errorbar([5.0], [6.0], yerr=0.5, fmt="none")
    _, rows = table(ax)
    assert [row["series"] for row in rows] == ["m", "m", "error bars"]
    assert column(rows, "y_low") == [2.9, 3.8, 5.5]
    assert column(rows, "y_high") == [3.3, 4.4, 6.5]
    assert column(rows, "x_low") == [0.9, 1.9, None]
    ax.figure.clear()
    bars = ax.figure.add_subplot()
    bars.barh(["radius", "modulus"], [0.2, 0.7])
    _, rows = table(bars)
    assert [(row["name"], row["x"]) for row in rows] == [("radius", "0.2"), ("modulus", "0.7")]


def test_points_and_areas(ax):
    ax.scatter([1.0, 2.0], [3.0, 4.0], c=[5.0, 6.0], label="sites")
    ax.fill_between([0.0, 1.0], 0.0, 1.0, label="reach")
    _, rows = table(ax)
    sites = [row for row in rows if row["series"] == "sites"]
    assert column(sites, "value") == [5.0, 6.0]
    corners = {row["x"] + row["y"] for row in rows if row["series"] == "reach"}
    assert corners == {"00", "01", "10", "11"}


@pytest.mark.parametrize("origin", ["lower", "upper"])
def test_images_and_meshes_have_their_values_at_their_places(ax, origin):
    value = np.arange(6.0).reshape(2, 3)
    ax.imshow(value, origin=origin, extent=(0.0, 3.0, 0.0, 2.0))
    ax.pcolormesh([0.0, 1.0], [5.0, 6.0], value[:, :2], shading="nearest")
    ax.figure.colorbar(ax.images[0])
    _, rows = table(ax)
    found = {(row["x"], row["y"]): float(row["value"]) for row in rows if row["series"] == "image 1"}
    rising = value if origin == "lower" else value[::-1]
    assert found == {(f"{x + 0.5}", f"{y + 0.5}"): rising[y, x] for y in range(2) for x in range(3)}
    mesh = [(row["x"], row["y"], row["value"]) for row in rows if row["series"] == "mesh"]
    assert mesh == [("0", "5", "0"), ("1", "5", "1"), ("0", "6", "3"), ("1", "6", "4")]


def test_long_series_and_large_images_are_thinned_and_the_table_says_so(ax):
    ax.plot(np.arange(2.5 * MOST_POINTS), label="long")
    ax.imshow(np.zeros((200, 200)))
    heads, rows = table(ax)
    assert heads[1] == "# panel 1, long: one of 3 of its 5000 points"
    images = [row for row in rows if row["series"].startswith("image 1 (one of 3 rows")]
    assert 0 < len(images) <= MOST_VALUES


def test_a_panel_without_names_takes_those_of_the_axis_that_it_shares():
    left, right = new_figure(5.0, 4.0).subplots(1, 2, sharey=True)
    left.set(xlabel="load P [N]", ylabel="area A0 [mm²]")
    twin = right.twinx()
    right.set_xlabel("load P [mN]")
    twin.set_ylabel("slope")
    left.plot([1.0], [1.0])
    heads, _ = table(left)
    assert [head.partition(": ")[2] for head in heads] == [
        *(f"x = load P [{unit}], y = area A0 [mm²]" for unit in ("N", "mN")), "x = load P [mN], y = slope",
    ]  # fmt: skip


def test_a_line_without_label_takes_that_of_the_lines_of_its_colour():
    left, right = new_figure(5.0, 4.0).subplots(1, 2)
    left.plot([1.0], [1.0], "C1", label="order 3")
    left.plot([1.0], [1.0], "C2", label="order 1")
    left.plot([1.0], [2.0], "C2", label="its fit")
    for colour in ("C1", "C2", "C3"):
        right.plot([1.0], [2.0], colour)
    _, rows = table(left)
    assert [row["series"] for row in rows[3:]] == ["order 3", "line 2", "line 3"]
