"""Handles of target laws: where they are, where they go, and what the text is then."""

import math
from functools import cache

import numpy as np
import pytest

from metafem.explorer.answer import answered
from metafem.explorer.fields import between, digits_of, rounded, scaled
from metafem.explorer.handles import MOST, added, moved, removed, scene_of
from metafem.explorer.history import State
from metafem.explorer.kinds import with_point
from metafem.files import demo_text, of_table, parsed, toml_table
from tests.explorer.scenes import TABLES, TARGETS, text_of

# What a browser can tell apart, and digits that tell a thousandth of a move apart.
RESOLUTION, FINE = 1e-3, 1e-12


@cache
def known(name):
    """Return the state of a target, its specification and its design, which points do not need."""
    state = State(text_of(name))
    specification = parsed(state.text, TABLES)
    points = hasattr(specification.target, "rescaled_friction")
    return state, specification, None if points else specification.design()


def scene(name):
    return scene_of(*known(name))


def target_of(table):
    return of_table(table, source=TABLES).target


def after(table, design=None):
    """Return the scene of a changed table, before its own design."""
    return scene_of(State("").edited(table), of_table(table, source=TABLES), design)


def by_id(table, design):
    return {each.id: each for each in after(table, design).handles()}


@pytest.mark.parametrize("name", TARGETS)
def test_a_handle_is_on_the_law_goes_where_it_is_moved_and_comes_back(name):
    state, specification, design = known(name)
    target, found = specification.target, scene(name).handles()
    assert len({each.id for each in found}) == len(found) > 0
    law = target.curve() if target.last_load is not None else None
    opened = law is not None and law.is_open
    before = state.table
    for each in found:
        if law is not None and not opened:
            assert each.friction == pytest.approx(np.interp(each.load, law.load, law.middle), rel=0.01)
        load = each.load * (1.02 if "x" in each.moves else 1.0)
        friction = each.friction * (1.03 if "y" in each.moves else 1.0)
        new = moved(scene(name), each.id, load, friction, RESOLUTION)
        now = by_id(new, design)[each.id]
        assert now.load == pytest.approx(load, rel=RESOLUTION)
        if "y" in each.moves and not opened:  # differences lose digits
            assert now.friction == pytest.approx(friction, rel=5 * RESOLUTION)
        assert {**before, "target": 0} == {**new, "target": 0}
        if name != "table":
            assert units(before["target"]) == units(new["target"])
        # the level of an open law is another one after the move
        fine = moved(scene(name), each.id, load, friction, FINE)
        back = scene(name) if opened else after(fine, design)
        again = by_id(moved(back, each.id, each.load, each.friction, FINE), design)
        for old in found:
            assert again[old.id].moves == old.moves
            assert again[old.id].load == pytest.approx(old.load, rel=1e-9)
            assert again[old.id].friction == pytest.approx(old.friction, rel=1e-6)


def units(value):
    """Return a target without its numbers."""
    if isinstance(value, dict):
        return {key: units(each) for key, each in value.items()}
    if isinstance(value, list):
        return [units(each) for each in value]
    return value.lstrip("0123456789.e+-") if isinstance(value, str) else float


@pytest.mark.parametrize("name", ["line", "lines", "multilinear", "bilinear"])
def test_branches_have_their_slopes_between_their_loads(name):
    load, friction = scene(name).curve()
    slopes = np.diff(friction) / np.diff(load)
    wanted = np.atleast_1d(getattr(scene(name).target, "slopes", getattr(scene(name).target, "slope", None)))
    for slope in wanted:
        assert np.isclose(slopes, slope, rtol=1e-9).any()
    ends = [each.load for each in scene(name).handles() if each.id.startswith("range-")]
    assert not ends or (load[0], load[-1]) == pytest.approx(ends)


def test_curves_of_points_powers_and_lines_without_a_design():
    load, friction = scene("points").curve()
    np.testing.assert_allclose([load[0], friction[0]], [0.144, 0.84])
    load, friction = scene("prefactor").curve()
    np.testing.assert_allclose(friction, 7.0 * load**0.9)
    at = scene_of(*known("bilinear")[:2], None)
    first, second, crossover = at.handles()
    load, friction = at.curve()
    slopes = np.diff(friction) / np.diff(load)
    np.testing.assert_allclose(slopes[np.isfinite(slopes)], [7.15, 12.52])
    load = load[np.isfinite(load)]
    assert load[1] == crossover.load == 0.038
    np.testing.assert_allclose((load[:-1] + load[1:]) / 2.0, [first.load, second.load])
    (slope,) = scene_of(*known("linear")[:2], None).handles()
    assert (slope.load, slope.carried) == (pytest.approx(0.05 * 64 * 0.12 * 0.526), "slope = 6.87")
    assert scene("coefficient").handles()[0].carried == "μ = 1.55"


def test_slopes_and_exponents_turn_about_their_pivots():
    first, second, *_ = scene("multilinear").handles()
    target = target_of(moved(scene("multilinear"), "slope-0", first.load, 1.02 * first.friction, 1e-9))
    assert target.slopes[0] == pytest.approx(9.5 + 0.02 * first.friction / first.load)
    target = target_of(moved(scene("multilinear"), "slope-1", second.load, second.friction + 0.1, 1e-9))
    assert target.slopes[1] == pytest.approx(8.0 + 0.1 / (second.load - 0.07))
    handle, *_ = scene("power").handles()
    target = target_of(moved(scene("power"), handle.id, handle.load, 1.1 * handle.friction, 1e-9))
    assert target.exponent == pytest.approx(0.9 + math.log(1.1) / math.log(handle.load / 0.2))


def test_numbers_have_the_digits_of_the_resolution_and_stay_between_their_neighbours():
    for resolution, load in ((1e-2, "0.234 mm^2"), (1e-3, "0.2345 mm^2"), (1e-5, "0.234457 mm^2")):
        new = moved(scene("points"), "point-1", 0.234457, 1.6, resolution)
        assert new["target"]["rescaled_load"][1] == load
    assert [digits_of(r) for r in (0.1, 1e-3, 1e-30)] == [2, 4, 15]
    assert rounded(12345.6, 1e-3) == 12350.0
    assert scaled("1 mm^2", 1e-7, 1e-3) == "1e-07 mm^2"
    for point, to, load, friction in (
        ("point-1", 9.0, 0.649 * 0.998, 4.12 * 0.998),
        ("point-1", 0.0, 0.144 * 1.002, 0.84 * 1.002),
        ("point-0", 0.0, 0.336e-3, 1.68e-3),
    ):
        target, i = target_of(moved(scene("points"), point, to, to)), int(point[-1])
        assert target.rescaled_load[i] == pytest.approx(load, rel=1e-3)
        assert target.rescaled_friction[i] == pytest.approx(friction, rel=1e-3)
    for value in (0.0, 1.0, 1.0 + 1e-13, 5.0):
        for gap in (1e-12, 1e-6, 1e-3, 1.0):
            placed, fine = between(value, 1.0, 1.0 + gap, RESOLUTION)
            assert 1.0 < rounded(placed, fine) < 1.0 + gap
            assert fine <= RESOLUTION


@pytest.mark.parametrize("name", ["one", "samples"])
def test_a_point_is_added_and_removed_again(name):
    before = known(name)[1].target
    for load, friction in ((0.01, 0.02), (0.3, 1.5), (0.9, 5.0), (0.336, 1.68)):
        new = added(scene(name), load, friction)
        found = target_of(new)
        assert len(found.rescaled_load) == len(before.rescaled_load) + 1
        (i,) = set(range(len(found.rescaled_load))) - {
            int(np.abs(found.rescaled_load - other).argmin()) for other in before.rescaled_load
        }
        if load == 0.9:
            np.testing.assert_allclose([found.rescaled_load[i], found.rescaled_friction[i]], [0.9, 5.0], 1e-3)
        again = target_of(removed(after(new), f"point-{i}"))
        np.testing.assert_allclose(again.rescaled_load, before.rescaled_load, rtol=1e-13)
        np.testing.assert_allclose(again.rescaled_friction, before.rescaled_friction, rtol=1e-13)
        if name == "samples":
            np.testing.assert_array_equal(again.weight, before.weight)


def test_points_near_the_law_are_on_it_and_the_fifth_makes_a_curve():
    table = toml_table(demo_text("operating-points"))
    design = of_table(table).design()
    for count in (4, 5):
        at = after(table, design)
        load = 0.1 * count
        friction = np.interp(load, design.law.rescaled_load, design.law.rescaled_friction)
        table = added(at, load, friction + 0.04, 0.05)
        target = target_of(table)
        i = int(np.abs(target.rescaled_load - load).argmin())
        assert target.rescaled_friction[i] == pytest.approx(friction, rel=1e-6)
    assert table["target"]["kind"] == "sampled"
    drawn = answered(at.state, 1)
    assert with_point(drawn, load, friction + 0.04, 0.05) != added(at, load, friction + 0.04)
    far = target_of(added(at, load, friction + 0.06, 0.05))
    assert far.rescaled_friction[i] == pytest.approx(friction + 0.06, rel=1e-3)


def test_tables_optional_values_and_crowds():
    new = moved(scene("table"), "point-1", 0.15, 0.9)
    section = new["target"]
    assert "file" not in section
    assert section["load"] == ["0.1 N", "0.204 N", "0.3 N"]
    assert section["friction_force"][::2] == ["0.17 N", "0.5 N"]
    assert section["weight"] == [1.0, 2.0, 1.0]
    assert target_of(removed(scene("line"), "range-low")).load_range is None
    assert target_of(removed(scene("prefactor"), "prefactor")).prefactor is None
    for count in (MOST, MOST + 1):
        rows = "".join(f"{0.001 * i},{0.01 * i}\n" for i in range(1, count + 1))
        table = {"wanted.csv": f"rescaled_load_mm2,rescaled_friction_mm2\n{rows}".encode()}
        at = scene_of(State(text_of("table")), parsed(text_of("table"), table), None)
        many = count > MOST
        assert len(at.handles()) == (0 if many else count)
        assert at.crowd == (count if many else 0)
