"""What the chapter on cost measures with: grids, times, references, and the README's table of the models."""

import itertools
import re
from xml.dom import minidom

import numpy as np
import pytest

import metafem as mf
from validation.cost import choice, ladder_picture, model_table, peers, scaling, work_precision
from validation.cost.measured import Point, fastest_within
from validation.cost.peers import Grid
from validation.cost.times import (
    LEAST,
    exponent,
    floor,
    in_words,
    machine,
    percent,
    renewed,
    rounded,
    timed,
)
from validation.readme import README
from validation.scenes import costs

PAIR = mf.Surface(np.array([[0.0, 0.0], [1.1, 0.3]]), [0.1, 0.12], [0.5, 0.7], mf.Material(1.36))


def shown():
    """Rows of the README's table of models, as lists of cells."""
    part = README.read_text("utf-8").split(model_table.MARKS[0])[1].split(model_table.MARKS[1])[0]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in part.strip().splitlines()[2:]]


def test_grid_holds_the_highest_cap_at_each_cell():
    grid = Grid(PAIR, 0.02)
    profile, owner = grid.caps
    x, y = (each.ravel() for each in np.meshgrid(*grid.axes, indexing="ij"))
    rho2 = (x[:, None] - PAIR.position[:, 0]) ** 2 + (y[:, None] - PAIR.position[:, 1]) ** 2
    caps = PAIR.height - rho2 / (2.0 * PAIR.radius)
    near = (rho2 <= (0.9 * PAIR.radius) ** 2).any(axis=1)
    np.testing.assert_allclose(profile.ravel()[near], caps.max(axis=1)[near])
    assert (owner.ravel() == caps.argmax(axis=1))[near].all()


def test_moments_of_hertz_pressures_are_their_areas():
    grid, radii = Grid(PAIR, 0.005), (0.2, 0.3)
    x, y = grid.axes
    force = np.zeros((grid.side, grid.side))
    for (cx, cy), a in zip(PAIR.position, radii, strict=True):
        rho2 = (x[:, None] - cx) ** 2 + (y - cy) ** 2
        force += np.sqrt(np.maximum(a**2 - rho2, 0.0))
    # sampled pressures: the error falls as the power 3/2 of the cells per radius
    assert grid.moments(force) == pytest.approx(np.pi * np.square(radii).sum(), rel=0.1 / 40**1.5)


def test_a_time_is_the_median_of_several_runs():
    runs = []
    seconds, last = timed(lambda run: runs.append(run) or run, long=0.0)
    assert (runs, last) == ([0], 0)
    seconds, last = timed(lambda run: runs.append(run) or run)
    assert seconds > 0.0
    assert last + 1 >= LEAST
    assert floor(64) > 0.0


def test_a_renewed_surface_differs_in_its_sites_alone():
    other = renewed(PAIR, 0)
    assert (other.position != PAIR.position)[1].all()
    np.testing.assert_allclose(other.position, PAIR.position, rtol=1e-8)
    np.testing.assert_array_equal(other.height, PAIR.height)
    np.testing.assert_array_equal(other.radius, PAIR.radius)


def test_numbers_are_rounded_to_one_two_and_five():
    assert [in_words(t) for t in (1.4e-6, 3.9e-5, 0.4, 2.4, 9.9e-4)] == [
        "1 µs",
        "50 µs",
        "500 ms",
        "2 s",
        "1 ms",
    ]
    values = 10.0 ** np.linspace(-3.3, 4.1, 50)
    for value in values:
        assert rounded(value, down=True) <= value < 2.6 * rounded(value, down=True)
        assert 0.63 < rounded(value) / value < 1.6
    assert rounded(1e5, down=True) == pytest.approx(1e5)


def test_percentages_have_two_digits_and_no_exponent():
    values = (1.4708, 0.1, 3.576e-3, 1e-5, 6.31e-6, 0.0)
    assert [percent(each) for each in values] == ["150 %", "10 %", "0.36 %", "0.001 %", "0.00063 %", "0 %"]


def test_the_limit_of_an_error_of_second_order_is_exact():
    values = [3.0 + 0.2 * h**2 for h in (0.4, 0.2, 0.1)]
    limit, uncertainty = costs.extrapolated(values)
    assert limit == pytest.approx(3.0)
    assert uncertainty == pytest.approx(0.002)


def test_the_exponent_of_a_power_is_found_and_its_error_is_that_of_the_scatter():
    counts = np.array([1e3, 1e4, 1e5])
    slope, error, factor = exponent(counts, 3e-6 * counts**1.2)
    assert (slope, error, factor) == pytest.approx((1.2, 0.0, 3e-6), abs=1e-10)
    # ln 2 more at the middle moves no slope: the residuals are 1, -2 and 1 thirds of it
    slope, error, _ = exponent(counts, 3e-6 * counts**1.2 * [1.0, 2.0, 1.0])
    assert slope == pytest.approx(1.2)
    assert error == pytest.approx(np.log(2.0) * np.sqrt(2.0 / 3.0) / np.log(10.0) / np.sqrt(2.0))


def test_a_series_is_fitted_above_the_dense_limit_alone():
    counts = (64, 4096, 16384)
    seconds = tuple((1.0, 1.0) if n == 64 else (2e-6 * n, 2e-6 * n) for n in counts)
    measured = scaling.Series(counts, seconds)
    assert measured.fit()[0] == pytest.approx(1.0)
    assert measured.median(4096) == pytest.approx(2e-6 * 4096)


def test_the_fastest_point_within_an_error():
    found = tuple(Point("a", str(k), 1.0 + k, 1.0, 1.0, 0.1 / k, 0.1) for k in range(1, 5))
    assert fastest_within(found, "a", 0.04).setting == "3"
    assert fastest_within(found, "a", 0.01) is None


def test_scenes_are_as_their_titles_say():
    assert {name: scene.surface.count for name, scene in costs.SCENES.items()} == {
        "sparse": 64, "paper": 64, "dense": 64, "irregular": 64, "merged": 4, "several": 400, "many": 10_000
    }  # fmt: skip
    for scene in costs.SCENES.values():
        assert all(coarse == 2.0 * fine for coarse, fine in itertools.pairwise(scene.finest))
        if not scene.peer_cells:  # as the README states
            assert Grid(scene.surface, 0.04).side ** 2 > 1e7
    sites = costs.irregular().position
    distance = np.linalg.norm(sites[:, None] - sites, axis=-1)
    assert distance[~np.eye(64, dtype=bool)].min() >= 0.8


def test_errors_have_two_digits_and_none_is_below_that_of_the_reference():
    exact = costs.Reference(4.2, 0.04, 5.36e-5, 6.31e-6, 13.6)
    assert model_table.shown_errors((3.576e-3, 1.4708), exact) == ("0.36 %", "150 %")
    assert model_table.shown_errors((1e-5, 1e-6), exact) == ("below 0.0054 %", "below 0.00063 %")


def test_the_machine_is_stated_without_its_name():
    assert re.fullmatch(r"Measured on \d+ processor cores? with Python [\d.]+\w*, numpy \S+, .+\.", machine())


@pytest.mark.parametrize(("scene", "name"), [("paper", "error of A0(P): below"), ("many", "error of A0(P)")])
def test_rows_state_what_is_known_of_an_error(monkeypatch, scene, name):
    exact = costs.Reference(4.2, 0.04, 5e-5, 6e-6, 13.6)
    monkeypatch.setattr(work_precision, "reference", lambda _: exact)
    point = Point(work_precision.ORDER_3, "", 1e-3, 1e-3, 1e-5, 1e-5, 1e-6)
    rows = {row.name.split(", ")[-1]: row for row in work_precision._results(scene, point)}
    assert rows[name].value == (5e-5 if scene == "paper" else 1e-5)
    assert ("nothing independent" in rows[name].method) == (scene == "many")


def test_readme_shows_every_model_with_its_assumption_and_range():
    expected = [[f"`{name}`", assumes, span] for name, _, _, assumes, span in model_table.TABLE]
    assert [[row[0], row[1], row[-1]] for row in shown()] == expected
    for name, line, setting, *_ in model_table.TABLE:
        assert eval(f"mf.{name}", {"mf": mf}) == costs.SCENES["paper"].lines[line][setting]


def test_picture_is_drawn():
    document = minidom.parse(str(model_table.PICTURE))
    labels = re.findall(r"(Interacting|BoundaryElements|Independent|Automatic)\(", document.toxml())
    assert len(set(labels)) == 4
    for scene in ladder_picture.SHOWN:
        assert costs.SCENES[scene].title in document.toxml()


def solved(line, setting, cold, error, model=None, estimate=np.nan):
    return Point(line, setting, cold, cold, np.nan, error, 0.0, solved=model, estimate=estimate)


@pytest.fixture
def choices(monkeypatch):
    """Rows of the choices on the scene of the paper, by tolerance, from given times and errors."""
    points = (
        solved("Independent()", "", 1e-4, 4e-3),
        solved("Interacting(order=1)", "", 4e-4, 8e-4),
        solved(costs.ORDER_3, "", 5e-4, 2e-5),
        solved(costs.AUTOMATIC, "0.01", 2e-4, 4e-3, mf.Independent(), 5e-3),
        solved(costs.AUTOMATIC, "0.001", 1e-3, 2e-5, mf.Interacting(), 1e-5),
        solved(costs.AUTOMATIC, "0.0001", 1e-3, 2e-5, mf.Interacting(), 2e-4),
        solved(costs.AUTOMATIC, "1e-05", 9.0, 6e-5, mf.BoundaryElements(0.01), 1e-5),
    )
    monkeypatch.setattr(choice, "models", lambda _: points)
    monkeypatch.setattr(choice, "reference", lambda _: costs.Reference(4.2, 0.04, 5e-5, 6e-6, 13.6))
    return {each.tolerance: each for each in choice.choice("paper")}


def test_a_choice_is_needed_if_no_cheaper_model_is_within_the_tolerance(choices):
    assert {each.tolerance: each.needed for each in choices.values()} == {
        1e-2: True, 1e-3: False, 1e-4: True, 1e-5: True
    }  # fmt: skip
    assert not choices[1e-2].cheaper
    assert [*choices[1e-5].cheaper] == ["Independent()", "Interacting(order=1)", costs.ORDER_3]


def test_the_row_of_a_choice_states_the_next_cheaper_model(choices):
    rows = {tolerance: choice._cells(each) for tolerance, each in choices.items()}
    assert rows[1e-2] == ("independent", "200 µs", "0.5 %", "0.4 %", "none", "–", "–")
    assert rows[1e-3] == ("order 3 *", "1 ms", "0.001 %", "< 0.005 %", "order 1", "500 µs", "0.08 %")
    cells = "resolved, 10 µm"
    assert rows[1e-5] == (cells, "10 s", "0.001 %", "0.006 %", "order 3", "500 µs", "< 0.005 %")


def test_the_time_of_a_choice_is_compared_with_that_of_the_model_alone(choices):
    found = {row.name.partition(":")[0]: row.value for row in choice._overheads([*choices.values()])}
    # 0.2 over 0.1 ms, and twice 1 over 0.5 ms; resolved contacts are not timed with these cells
    assert found == {"Fig. 4 red, 64 asperities": 2.0}


def test_every_tolerance_has_a_row_on_every_scene(choices):
    parts = choice._table([*choices.values()]).parts
    assert [*parts] == [scene.title for scene in costs.SCENES.values()]
    for rows in parts.values():
        assert [row[0] for row in rows] == ["10 %", "1 %", "0.1 %", "0.01 %", "0.001 %"]
        assert {len(row) for row in rows} == {len(choice.HEADER)}
    assert parts["Fig. 4 red, 64 asperities"][0][1:3] == ("resolved", "not computed")


@pytest.fixture
def timed_beside_tamaas(monkeypatch):
    """Rows of the ratios, from times and errors that are given: the next load of tamaas takes 3 s."""
    own, moments = "tamaas", "tamaas, second moments"
    model = (
        (costs.ORDER_3, "", 1e-3, 1e-3, 1e-4, 1e-5, 1e-6),
        (costs.RESOLVED, "10 µm", 2.0, 2.0, 0.0, 4e-3, 1e-3),
    )
    other = [
        (own, 9.0, 0.02, 0.02),
        (own, 50.0, 4e-3, 0.01),
        (moments, 9.0, 3e-3, 0.02),
        (moments, 50.0, 8e-4, 0.01),
    ]
    points = tuple(
        Point(line, f"{cell}", cold, cold, np.nan, error, 0.0, cell) for line, cold, error, cell in other
    )
    monkeypatch.setattr(work_precision, "models", lambda _: tuple(Point(*each) for each in model))
    monkeypatch.setattr(work_precision, "peers", lambda _: points)
    monkeypatch.setattr(work_precision, "installed", lambda: {"tamaas": None})
    monkeypatch.setattr(work_precision, "next_load_with_tamaas", lambda grid, load: 3.0)
    return work_precision._ratios()


def test_times_are_compared_at_equal_error_cold_with_cold_and_say_how(timed_beside_tamaas):
    found = {row.name.partition(": ")[2]: row.value for row in timed_beside_tamaas}
    order_3, cells = f"over that of {costs.ORDER_3}", f"over that of {costs.RESOLVED}, 10 µm"
    cold, warm = "one load of a new surface", "each load of a curve"
    own, moments = "time of tamaas", "time of tamaas, second moments"
    # 9 or 50 s over 1 ms, 3 s over 0.1 ms, rounded down; no grid has an own area to 0.1 %
    assert found == {
        f"A0 to 0.5 %, {own} {order_3}, {cold}": 5e4,
        f"A0 to 0.5 %, {own} {order_3}, {warm}": 2e4,
        f"A0 to 0.5 %, {own} {cells}, {cold}": 20.0,
        f"A0 to 0.5 %, {moments} {order_3}, {cold}": 5e3,
        f"A0 to 0.5 %, {moments} {order_3}, {warm}": 2e4,
        f"A0 to 0.5 %, {moments} {cells}, {cold}": 2.0,
        f"A0 to 0.1 %, {moments} {order_3}, {cold}": 5e4,
        f"A0 to 0.1 %, {moments} {order_3}, {warm}": 2e4,
    }
    for row in timed_beside_tamaas:
        assert f"tolerance {peers.TAMAAS_TOLERANCE:g}" in row.method
        assert f"threads: {peers.THREADS}" in row.method
        assert re.search(r"error 0\.\d+ %", row.method)


@pytest.mark.slow
def test_errors_in_the_readme_are_those_of_the_models():
    exact = costs.reference("paper")
    for (_, line, setting, *_), row in zip(model_table.TABLE, shown(), strict=True):
        errors = costs.errors("paper", costs.SCENES["paper"].lines[line][setting])
        assert tuple(row[4:6]) == model_table.shown_errors(errors, exact)


@pytest.mark.slow
@pytest.mark.parametrize("code", list(peers.PEERS))
def test_other_codes_agree_with_resolved_contacts_on_the_same_cells(code):
    pytest.importorskip(code)
    grid, load = Grid(PAIR, 0.04), 0.1
    found = peers.installed()[code](grid, load)
    state = mf.equilibrium(PAIR, mf.BoundaryElements(0.04), load=load)
    assert found.load == pytest.approx(load)
    # the centres of the cells differ, whose effect is that of the side squared
    assert found.moments == pytest.approx(state.area, rel=0.01)
    assert found.separation == pytest.approx(state.separation, abs=1e-3)
    assert found.area == pytest.approx(state.area, rel=0.2)
