"""Handles of target laws: where they are drawn, and what the text is after they have moved."""

import math
import tomllib
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.explorer.text.handles import added, moved, removed, scene_of
from metafem.explorer.text.points import MOST
from metafem.explorer.text.written import between, digits_of, rounded, stated
from metafem.files import demo_text, parsed

REST = demo_text("linear").split("[material]")[1].replace('height_step = "6 um"', "")
FORCES = 'load = ["0.2 N", "450mN", "0.88 N"]\nfriction_force = ["0.26 N", "0.52 N", "1.29 N"]'
TARGETS = {
    "points": 'kind = "operating-points"\nrescaled_load = ["0.144 mm^2", "0.336 mm^2", "649e3 um^2"]\n'
    'rescaled_friction = ["0.84 mm^2", "1.68 mm^2", "4.12 mm²"]',
    "forces": f'kind = "operating-points"\n{FORCES}',
    "one": 'kind = "operating-points"\nload = ["0.2 N"]\nfriction_force = ["0.26 N"]',
    "samples": f'kind = "sampled"\n{FORCES}\nweight = [1.0, 2.0, 3.0]',
    "table": 'kind = "sampled"\nfile = "wanted.csv"',
    "linear": 'kind = "linear"\nslope = 6.87',
    "coefficient": 'kind = "linear"\nfriction_coefficient = 1.55',
    "line": 'kind = "linear"\nslope = 7\nload_range = ["0.1 N", "0.4 N"]',
    "bilinear": 'kind = "bilinear"\nslopes = [7.15, 12.52]\ncrossover_load = "0.0380 mm^2"',
    "lines": 'kind = "bilinear"\nfriction_coefficients = [1.6, 2.7]\ncrossover_load = "50 mN"\n'
    'load_range = ["0.035 N", "0.18 N"]',
    "power": 'kind = "power"\nexponent = 0.9\nload_range = ["0.1 mm^2", "0.4 mm^2"]',
    "prefactor": 'kind = "power"\nexponent = 0.9\nload_range = ["0.1 N", "0.4 N"]\nprefactor = 7',
    "multilinear": 'kind = "multilinear"\nslopes = [9.5, 8.0, 7.0]\nload_range = ["40 mN", "0.36 N"]\n'
    'crossover_loads = ["0.07 mm^2", ["0.15 mm^2", "0.24 N"]]',
}
TABLE = b"load_mN,friction_force_N,weight,remark\n100,0.17,1,a\n200,0.31,2,b\n300,0.5,1,c\n"
TABLES = {"wanted.csv": TABLE}
RESOLUTION = 1e-3


def text_of(name):
    return f"[target]\n{TARGETS[name]}\n[material]{REST}"


@cache
def scene(name):
    text = text_of(name)
    specification = parsed(text, TABLES)
    try:
        design = specification.design()
    except mf.Infeasible:
        design = None
    return text, specification, design


def target_of(text):
    return parsed(text, TABLES).target


@pytest.mark.parametrize("name", TARGETS)
def test_handles_are_on_the_target_law(name):
    text, specification, design = scene(name)
    found = scene_of(text, specification, design).handles()
    assert len({handle.id for handle in found}) == len(found) >= 1
    target = specification.target
    if target.last_load is not None:
        law = target.curve()
        friction = law.law(np.interp(law.load, design.law.rescaled_load, design.law.rescaled_friction)
                           if law.is_open else law.load)  # fmt: skip
        for handle in found:
            assert handle.friction == pytest.approx(np.interp(handle.load, law.load, friction), rel=0.02)
    ends = getattr(target, "load_range", None)
    assert ends is None or {"range-low", "range-high"} <= {handle.id for handle in found}


@pytest.mark.parametrize("name", TARGETS)
def test_a_handle_that_stays_changes_its_value_by_rounding_alone(name):
    text, specification, design = scene(name)
    for handle in scene_of(text, specification, design).handles():
        new = moved(scene_of(text, specification, design), handle.id, handle.load, handle.friction, 1e-9)
        before = scene_of(text, specification, design).handles()
        for old, now in zip(before, scene_of(new, parsed(new, TABLES), design).handles(), strict=True):
            assert (now.id, now.moves) == (old.id, old.moves)
            assert now.load == pytest.approx(old.load, rel=1e-7)
            assert now.friction == pytest.approx(old.friction, rel=1e-6)


@pytest.mark.parametrize("name", TARGETS)
def test_a_handle_goes_where_it_is_moved(name):
    text, specification, design = scene(name)
    for handle in scene_of(text, specification, design).handles():
        load = handle.load * (1.02 if "x" in handle.moves else 1.0)
        friction = handle.friction * (1.03 if "y" in handle.moves else 1.0)
        new = moved(scene_of(text, specification, design), handle.id, load, friction, RESOLUTION)
        (now,) = [h for h in scene_of(new, parsed(new, TABLES), design).handles() if h.id == handle.id]
        assert now.load == pytest.approx(load, rel=RESOLUTION)
        if "y" in handle.moves and not is_open(specification.target):  # differences lose digits
            assert now.friction == pytest.approx(friction, rel=5 * RESOLUTION)
        before, after = tomllib.loads(text), tomllib.loads(new)
        assert {**before, "target": 0} == {**after, "target": 0}


def is_open(target):
    return target.last_load is not None and target.curve().is_open


def test_a_line_with_a_free_intercept_turns_about_that_of_the_design():
    text, specification, design = scene("multilinear")
    first, second, *_ = scene_of(text, specification, design).handles()
    target = target_of(
        moved(scene_of(text, specification, design), "slope-0", first.load, 1.02 * first.friction, 1e-9)
    )
    assert target.slopes[0] == pytest.approx(9.5 + 0.02 * first.friction / first.load)
    target = target_of(
        moved(scene_of(text, specification, design), "slope-1", second.load, second.friction + 0.1, 1e-9)
    )
    assert target.slopes[1] == pytest.approx(8.0 + 0.1 / (second.load - 0.07))


def test_a_power_law_turns_about_the_middle_of_its_range():
    text, specification, design = scene("power")
    handle, *_ = scene_of(text, specification, design).handles()
    target = target_of(
        moved(scene_of(text, specification, design), handle.id, handle.load, 1.1 * handle.friction, 1e-9)
    )
    assert target.exponent == pytest.approx(0.9 + math.log(1.1) / math.log(handle.load / 0.2))


@pytest.mark.parametrize("name", TARGETS)
def test_units_and_keys_stay(name):
    text, specification, design = scene(name)

    def units(value):
        if isinstance(value, list):
            return [units(entry) for entry in value]
        return value.lstrip("0123456789.e+-") if isinstance(value, str) else type(value)

    for handle in scene_of(text, specification, design).handles():
        new = moved(
            scene_of(text, specification, design), handle.id, 1.01 * handle.load, 1.01 * handle.friction
        )
        before, after = (tomllib.loads(each)["target"] for each in (text, new))
        if name != "table":
            assert before.keys() == after.keys()
            assert [units(before[k]) for k in before if k not in ("slope", "prefactor")] == [
                units(after[k]) for k in before if k not in ("slope", "prefactor")
            ]


def test_digits_are_those_that_the_resolution_needs():
    text, specification, _ = scene("points")
    for resolution, load in ((1e-2, "0.234 mm^2"), (1e-3, "0.2345 mm^2"), (1e-5, "0.234457 mm^2")):
        new = moved(scene_of(text, specification, None), "point-1", 0.234457, 1.6, resolution)
        assert tomllib.loads(new)["target"]["rescaled_load"][1] == load
    assert [digits_of(r) for r in (0.1, 1e-3, 1e-30)] == [2, 4, 15]
    assert rounded(12345.6, 1e-3) == 12350.0
    assert stated(1e-7, "1 mm^2", None, 1e-3) == "1e-07 mm^2"


def test_a_point_stays_between_its_neighbours():
    text, specification, _ = scene("points")
    target = target_of(moved(scene_of(text, specification, None), "point-1", 9.0, 9.0))
    assert 0.336 < target.rescaled_load[1] < 0.649
    assert target.rescaled_load[1] == pytest.approx(0.649, rel=4e-3)
    assert target.rescaled_friction[1] == pytest.approx(4.12, rel=4e-3)
    target = target_of(moved(scene_of(text, specification, None), "point-1", 0.0, 0.0))
    assert target.rescaled_load[1] == pytest.approx(0.144, rel=4e-3)
    target = target_of(moved(scene_of(text, specification, None), "point-0", 0.0, 0.0))
    assert 0.0 < target.rescaled_load[0] < 1e-3


@settings(max_examples=40)
@given(
    st.floats(0.0, 10.0), st.floats(1e-9, 10.0), st.floats(1e-12, 1.0), st.sampled_from([1e-2, 1e-3, 1e-6])
)
def test_a_value_between_two_others_is_written_between_them(value, low, gap, resolution):
    high = low * (1.0 + gap)
    placed, fine = between(value, low, high, resolution)
    assert low < rounded(placed, fine) < high
    assert fine <= resolution


def test_points_of_a_table_are_written_into_the_text():
    text, specification, _ = scene("table")
    new = moved(scene_of(text, specification, None), "point-1", 0.15, 0.9)
    section = tomllib.loads(new)["target"]
    assert "file" not in section
    assert section["load"] == ["0.1 N", "0.204 N", "0.3 N"]
    assert section["friction_force"][::2] == ["0.17 N", "0.5 N"]
    assert section["weight"] == [1.0, 2.0, 1.0]
    assert parsed(new).target.rescaled_load[1] == pytest.approx(0.15)


@pytest.mark.parametrize("name", ["points", "forces", "one", "samples", "table"])
@pytest.mark.parametrize(("load", "friction"), [(0.01, 0.02), (0.3, 1.5), (0.9, 5.0), (0.336, 1.68), (0, 0)])
def test_a_point_is_added_and_removed_again(name, load, friction):
    text, specification, _ = scene(name)
    new = added(scene_of(text, specification, None), load, friction)
    before, after = specification.target, parsed(new).target
    assert len(after.rescaled_load) == len(before.rescaled_load) + 1
    (i,) = set(range(len(after.rescaled_load))) - {
        int(np.abs(after.rescaled_load - other).argmin()) for other in before.rescaled_load
    }
    if (load, friction) == (0.9, 5.0):
        np.testing.assert_allclose([after.rescaled_load[i], after.rescaled_friction[i]], [0.9, 5.0], 1e-3)
    again = parsed(removed(scene_of(new, parsed(new), None), f"point-{i}")).target
    np.testing.assert_allclose(again.rescaled_load, before.rescaled_load, rtol=1e-13)
    if name == "samples":
        np.testing.assert_array_equal(again.weight, before.weight)


def test_what_cannot_be_added_or_removed_is_said():
    text, specification, _ = scene("one")
    with pytest.raises(mf.InvalidInput, match="the last point cannot be removed"):
        removed(scene_of(text, specification, None), "point-0")
    text, specification, _ = scene("multilinear")
    with pytest.raises(mf.InvalidInput, match="a multilinear law is not given by points"):
        added(scene_of(text, specification, None), 0.1, 1.0)
    with pytest.raises(mf.InvalidInput, match="cannot be removed"):
        removed(scene_of(text, specification, None), "range-low")
    with pytest.raises(mf.InvalidInput, match='no handle "point-7"'):
        moved(scene_of(*scene("points")), "point-7", 0.1, 1.0)
    with pytest.raises(mf.InvalidInput, match="has problems"):
        moved(scene_of(text, None, None), "point-0", 0.1, 1.0)
    for load, friction in ((-0.1, 1.0), (0.1, math.nan), (math.inf, 1.0)):
        with pytest.raises(mf.InvalidInput, match="must be a finite number of at least 0"):
            moved(scene_of(*scene("points")), "point-0", load, friction)


def test_what_is_optional_is_removed_by_its_handle():
    text, specification, _ = scene("line")
    assert target_of(removed(scene_of(text, specification, None), "range-low")).load_range is None
    text, specification, _ = scene("prefactor")
    assert target_of(removed(scene_of(text, specification, None), "prefactor")).prefactor is None


DRAGS = st.lists(
    st.tuples(
        st.integers(0, 9),
        st.one_of(st.floats(0.0, 3.0), st.floats(0.0, allow_infinity=False)),
        st.one_of(st.floats(0.0, 9.0), st.floats(0.0, allow_infinity=False)),
    ),
    min_size=1,
    max_size=3,
)


@pytest.mark.parametrize("examples", [10, pytest.param(60, marks=pytest.mark.slow)])
def test_any_drag_leaves_a_valid_text_or_a_clear_problem(examples):
    drawn = given(st.sampled_from(sorted(TARGETS)), DRAGS)
    settings(max_examples=examples)(drawn(assert_valid_or_clear))()


def assert_valid_or_clear(name, steps):
    text, specification, design = scene(name)
    problems, extreme = [], False
    for which, load, friction in steps:
        found = scene_of(text, specification, design).handles()
        values = [value for value in (load, friction) if value != 0.0]
        extreme |= max(values, default=1.0) > 1e6 or min(values, default=1.0) < 1e-30
        try:
            text = moved(scene_of(text, specification, design), found[which % len(found)].id, load, friction)
            specification = parsed(text, TABLES)
        except mf.InvalidInput as error:
            problems.extend(error.problems or [error.within("target")])
            break
    assert extreme or not problems
    assert all(problem.key.startswith("target") for problem in problems)


@pytest.mark.parametrize("id", ["exponent", "prefactor"])
def test_a_power_below_the_smallest_number_is_not_moved_by_hand(id):
    text, _, design = scene("prefactor")
    text = text.replace("exponent = 0.9", "exponent = 500")
    with pytest.raises(mf.InvalidInput, match=r"target\.load_range: .* cannot be moved by hand"):
        moved(scene_of(text, parsed(text, TABLES), design), id, 0.1, 1.0)


def test_a_crowd_of_points_has_no_handles():
    for count in (MOST, MOST + 1):
        table = "rescaled_load_mm2,rescaled_friction_mm2\n" + "".join(
            f"{0.001 * i},{0.01 * i}\n" for i in range(1, count + 1)
        )
        text = f'[target]\nkind = "sampled"\nfile = "wanted.csv"\n[material]{REST}'
        specification = parsed(text, {"wanted.csv": table.encode()})
        many = count > MOST
        scene = scene_of(text, specification, None)
        assert len(scene.handles()) == len(scene.shape().follows) == (0 if many else count)
        assert scene.crowd == (count if many else 0)
