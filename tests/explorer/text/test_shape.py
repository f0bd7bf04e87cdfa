"""What follows a handle at once is what the text says after it has moved."""

import numpy as np
import pytest

from metafem.explorer.text.handles import MARKS, moved, scene_of
from metafem.explorer.text.lines import LineHandles
from metafem.files import demo_text, parsed

REST = demo_text("linear").split("[material]")[1].replace('height_step = "6 um"', "")
LINES = {
    "linear": 'kind = "linear"\nslope = 6.87',
    "line": 'kind = "linear"\nslope = 7\nload_range = ["0.1 N", "0.4 N"]',
    "bilinear": 'kind = "bilinear"\nslopes = [7.15, 12.52]\ncrossover_load = "0.0380 mm^2"',
    "lines": 'kind = "bilinear"\nslopes = [7.0, 12.0]\ncrossover_load = "0.04 mm^2"\n'
    'load_range = ["0.02 mm^2", "0.13 mm^2"]',
    "joined": 'kind = "multilinear"\nslopes = [9.5, 8.0, 7.0]\nload_range = ["0.03 mm^2", "0.26 mm^2"]\n'
    'crossover_loads = ["0.07 mm^2", "0.16 mm^2"]',
    "parted": 'kind = "multilinear"\nslopes = [9.5, 8.0, 7.0]\nload_range = ["0.03 mm^2", "0.26 mm^2"]\n'
    'crossover_loads = ["0.07 mm^2", ["0.15 mm^2", "0.18 mm^2"]]',
}
POINTS = """kind = "sampled"
rescaled_load = ["0.1 mm^2", "0.2 mm^2"]
rescaled_friction = ["1 mm^2", "2 mm^2"]
"""

# Digits of a text that tell a thousandth of a move apart.
FINE = 1e-12


def scene(target):
    text = f"[target]\n{target}\n[material]{REST}"
    specification = parsed(text)
    straight = specification.target.last_load is None  # whose lines are those of the design
    return text, specification, specification.design() if straight else None


@pytest.fixture(scope="module", params=LINES)
def line(request):
    return (request.param, *scene(LINES[request.param]))


def applied(shape, found, id, by):
    """Return corners (k, 2) and handles that follow a move of a handle, as the browser moves them."""
    corners = np.stack([shape.load, shape.friction], axis=1)
    places = {each.id: np.array([each.load, each.friction]) for each in found}
    places[id] = places[id] + by

    def moves(shift):
        return np.array([shift.x * by[0], shift.across * by[0] + shift.y * by[1]])

    for key, shift in shape.follows[id].items():
        if isinstance(key, int):
            corners[key] += moves(shift)
            continue
        before = next(each for each in found if each.id == key)
        places[key] = np.array([before.load, before.friction]) + moves(shift)
    return corners, places


def test_the_corners_and_the_handles_are_those_of_the_text_after_the_move(line):
    name, text, specification, design = line
    at = scene_of(text, specification, design)
    found, shape = at.handles(), at.shape()
    for handle in found:
        by = np.array([0.001 * handle.load, 0.0] if handle.moves == "x" else [0.0, 0.01 * handle.friction])
        new = moved(
            scene_of(text, specification, design),
            handle.id,
            handle.load + by[0],
            handle.friction + by[1],
            FINE,
        )
        at = scene_of(new, parsed(new), design)
        wanted, target = at.handles(), at.shape()
        corners, places = applied(shape, found, handle.id, by)
        slopes = [np.diff(each[:, 1]) / np.diff(each[:, 0])
                  for each in (corners, np.stack([target.load, target.friction], axis=1))]  # fmt: skip
        if name in ("line", "lines"):  # whose intercepts are known
            np.testing.assert_allclose(corners[:, 0], target.load, rtol=1e-9)
            np.testing.assert_allclose(corners[:, 1], target.friction, rtol=1e-9)
            for each in wanted:
                np.testing.assert_allclose(places[each.id], [each.load, each.friction], rtol=1e-9)
        elif name != "parted" or handle.id != "crossover-1-start":
            known = np.isfinite(slopes[0])
            known[2:3] &= name != "parted"  # between a pair of loads the law is free
            np.testing.assert_allclose(slopes[0][known], slopes[1][known], rtol=1e-9)
        if specification.target.last_load is not None:  # else the branches of the next design end elsewhere
            np.testing.assert_allclose(corners[:, 0], target.load, rtol=1e-9)


def test_handles_stay_on_the_lines_that_they_change(line):
    _, text, specification, design = line
    at = scene_of(text, specification, design)
    found, shape = at.handles(), at.shape()
    for handle in found:
        by = np.array([0.001 * handle.load, 0.0] if handle.moves == "x" else [0.0, 0.01 * handle.friction])
        corners, places = applied(shape, found, handle.id, by)
        known = np.isfinite(corners[:, 0])
        for name, (load, friction) in places.items():
            if corners[known, 0].min() <= load <= corners[known, 0].max() and "crossover" not in name:
                on = np.interp(load, corners[known, 0], corners[known, 1])
                assert friction == pytest.approx(on, rel=1e-9), (handle.id, name)


def test_points_carry_their_own_corner():
    at = scene_of(*scene(POINTS))
    found, shape = at.handles(), at.shape()
    corners, places = applied(shape, found, "point-1", np.array([0.01, 0.5]))
    np.testing.assert_allclose(corners, [[0.1, 1.0], [0.21, 2.5]])
    np.testing.assert_allclose(places["point-1"], [0.21, 2.5])
    np.testing.assert_allclose(places["point-0"], [0.1, 1.0])


def test_a_slope_is_drawn_about_its_handle_before_any_design():
    text, specification, _ = scene(LINES["bilinear"])
    at = scene_of(text, specification, None)
    found, shape = at.handles(), at.shape()
    np.testing.assert_allclose(np.diff(shape.friction) / np.diff(shape.load), [7.15, 12.52])
    assert shape.load[1] == 0.038
    first, second, crossover = found
    np.testing.assert_allclose((shape.load[:-1] + shape.load[1:]) / 2.0, [first.load, second.load])
    assert crossover.load == 0.038


def test_curves_follow_with_the_answers():
    text = 'kind = "power"\nexponent = 0.9\nload_range = ["0.1 mm^2", "0.4 mm^2"]\nprefactor = 7.0'
    at = scene_of(*scene(text))
    found, shape = at.handles(), at.shape()
    np.testing.assert_allclose(shape.friction, 7.0 * shape.load**0.9)
    assert shape.follows == {}
    assert len(found) == 4


def test_every_kind_has_a_shape():
    assert all("shape" in vars(each) for each in MARKS.values())
    assert issubclass(MARKS["multilinear"], LineHandles)
