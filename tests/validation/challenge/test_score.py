"""The scorer of the challenge: against metafem, without metafem, and on broken entries."""

import json
import subprocess
import sys
from functools import partial

import numpy as np
import pytest

import metafem as mf
from validation.challenge import resolved, score
from validation.challenge.best_results import best, path_of
from validation.challenge.caps import Caps, Tool
from validation.challenge.entry import broken, made
from validation.challenge.substrate import HalfSpace, Layer, PeriodicHalfSpace, point_loads
from validation.challenge.sums import coupled, independent
from validation.challenge.task import FOLDER, BadInput, names, target

TOOLS = (Tool(0.526), Tool(0.8, 4.0), Tool(0.4, 1.5, 0.7), Tool(0.5, sphere=True))
CAPS = (mf.Paraboloid(), mf.Power(4.0), mf.Power(1.5, 0.7), mf.Sphere())
LOAD = np.linspace(0.01, 0.3, 8)

SUBSTRATES = {
    "half-space": (HalfSpace(), mf.HalfSpace(), None),
    "layer": (Layer(7.2), mf.BondedLayer(), None),
    "periodic": (PeriodicHalfSpace(6.0, 6.0), mf.HalfSpace(), mf.PeriodicCell(6.0, 6.0)),
}


def scene(count, kinds):
    """Return tools of asperities, and a surface of metafem with the same caps."""
    rng = np.random.default_rng(0)
    index = rng.integers(0, kinds, count**2)
    surface = mf.Surface.square_lattice(
        0.1 + rng.exponential(0.02, count**2),
        (count, count),
        1.5,
        radius=np.array([tool.radius for tool in TOOLS])[index],
        material=mf.Material(1.36),
        block=mf.Block(20.0, 20.0, 7.2),
        cap=[CAPS[i] for i in index],
    )
    return index, surface


def test_independent_sums_agree_with_metafem():
    index, surface = scene(4, 4)
    area, stiffness = independent(Caps.of(TOOLS, index), surface.height, LOAD)
    curve = mf.Independent(contact=mf.Elastic()).curve(surface, LOAD)
    np.testing.assert_allclose(area, curve.area, rtol=1e-9)  # the bound that the challenge states
    approach = mf.Independent(contact=mf.Elastic()).curve(surface, LOAD * (1.0 + 1e-6)).approach
    np.testing.assert_allclose(stiffness, 1e-6 * LOAD / (approach - curve.approach), rtol=1e-5)


@pytest.mark.parametrize("which", SUBSTRATES)
def test_point_loads_agree_with_metafem(which):
    own, theirs, cell = SUBSTRATES[which]
    index, surface = scene(4, 4)
    influence = point_loads(own, surface.position)
    area, load = coupled(Caps.of(TOOLS, index), surface.height, LOAD, influence)
    curve = mf.Interacting(order=1, substrate=theirs, contact=mf.Elastic()).curve(
        surface.replaced(cell=cell), LOAD
    )
    np.testing.assert_allclose(area.sum(axis=1), curve.area, rtol=1e-9)
    np.testing.assert_allclose(load.sum(axis=1), LOAD, rtol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("which", "kinds"), [("periodic", 1), *((which, 3) for which in SUBSTRATES)])
def test_resolved_contacts_agree_with_metafem(which, kinds):
    own, theirs, cell = SUBSTRATES[which]
    index, surface = scene(3, kinds)
    if cell is not None:
        own, cell = PeriodicHalfSpace(4.5, 4.5), mf.PeriodicCell(4.5, 4.5)
    load = LOAD[[1, -1]]
    tools = [TOOLS[i] for i in index]
    area = resolved.areas(tools, surface.position, surface.height, load, resolved.Grid(own, surface.position))
    model = mf.BoundaryElements(cell=0.006, substrate=theirs, contact=mf.Elastic())
    curve = model.curve(surface.replaced(cell=cell), load)
    np.testing.assert_allclose(area.sum(axis=1), curve.area, rtol=2e-3)  # the bound that the challenge states


def test_scorer_needs_numpy_alone():
    code = (
        "import sys\n"
        "for name in ('scipy', 'metafem', 'numba', 'matplotlib'): sys.modules[name] = None\n"
        "from validation.challenge.score import main\n"
        "sys.exit(main(['--quick', sys.argv[1]]))\n"
    )
    path = FOLDER.parent / "best" / "01-power-law.json"
    done = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("01-power-law: misfit")


@pytest.mark.parametrize("name", names())
def test_specifications_are_those_of_metafem(name):
    wanted = target(name)
    if not wanted.for_metafem:
        with pytest.raises(mf.InvalidInput):
            mf.read_spec(FOLDER / f"{name}.toml")
        return
    spec = mf.read_spec(FOLDER / f"{name}.toml")
    np.testing.assert_allclose(spec.template.position, wanted.sites)
    curve = spec.target.curve()
    np.testing.assert_allclose(curve.load, wanted.friction.load, rtol=1e-12)
    area = curve.load**0.8
    largest = np.abs(curve.difference(area)).max() if curve.pointwise else curve.misfit(area)
    assert wanted.misfit(area, None) == pytest.approx(largest, rel=1e-9)


# The contacts of these take minutes: `python -m validation.challenge.score validation/challenge/best/*.json`
# resolves them, and compares the misfits with the stated ones.
LONG = {"07-half-space": mf.HalfSpace(), "08-bonded-layer": mf.BondedLayer()}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * target(name).resolved)
        for name in names()
        if name not in LONG
    ],
)
def test_best_results_score_as_they_state(name):
    found = score.score(best(name))
    assert not found.broken
    assert found.stated is None  # its misfit is the stated one


@pytest.mark.parametrize("name", LONG)
def test_stated_misfits_of_interacting_contacts_are_those_of_order_3(name):
    entry = best(name)
    (tool,) = entry.target.tools
    surface = mf.Surface(
        entry.position, entry.height, tool.radius, mf.Material(1.36), block=mf.Block(20.0, 20.0, 7.2)
    )
    area = mf.Interacting(substrate=LONG[name]).curve(surface, entry.target.friction.load).area
    assert not broken(entry)
    # misfits differ by at most the rms of the relative differences of the areas
    assert entry.target.misfit(area, None) == pytest.approx(entry.stated["misfit"], abs=resolved.ERROR)


@pytest.mark.slow
@pytest.mark.parametrize("name", LONG)
def test_contacts_on_large_cells_have_the_stated_misfit_within_their_error(name, monkeypatch):
    entry, cell = best(name), 0.04
    monkeypatch.setattr(score, "resolved_misfit", partial(score.resolved_misfit, cell=cell))
    # the error of the areas falls with the square of the side of the cells
    error = resolved.ERROR * (cell / resolved.CELL) ** 2
    assert score.score(entry).misfit == pytest.approx(entry.stated["misfit"], abs=error)


def changed(**values):
    """Return an entry of 64 asperities for the first target with some values changed."""
    wanted = target("01-power-law")
    given = {"target": wanted.name, "position": wanted.sites.tolist(), "height": [0.1] * 64}
    return {**given, **values}


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"target": "13-none"}, "13-none.*is unknown.*01-power-law"),
        ({"height": []}, "height must be a list"),
        ({"height": [0.1]}, r"position must hold x and y .* of each of the 1 heights"),
        ({"height": [float("nan")] * 64}, r"height\[0\] is not finite"),
        ({"height": ["high"] * 64}, "height must hold numbers"),
        ({"tool": [1]}, "tool has 1 entries for 64"),
        ({"tool": [2] * 64}, r"tool\[0\] = 2 must be a whole number from 1 to 1"),
        ({"misfit": "small"}, "misfit = 'small' must be a number, such as 0.0123"),
        ({"misfit": [0.1]}, r"misfit = \[0.1\] must be a number"),
    ],
)
def test_unreadable_entries_are_named(values, words):
    with pytest.raises(BadInput, match=words):
        made(changed(**values))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"height": [0.3] * 64}, "height[0] = 0.3 mm is above 0.27 mm"),
        ({"height": [-0.1] * 64}, "height[0] = -0.1 mm is not positive"),
        ({"position": [[0.0, 0.0]] * 64}, "from the nearest site of the lattice"),
        ({"position": [[0.75, 0.75]] * 64}, "on a site that another asperity occupies"),
    ],
)
def test_broken_limits_are_named(values, words):
    assert any(words in each for each in broken(made(changed(**values))))


def test_exit_codes(tmp_path, capsys):
    good, high, bad = (tmp_path / f"{name}.json" for name in ("good", "high", "bad"))
    good.write_text(json.dumps(changed()), "utf-8")
    high.write_text(json.dumps(changed(height=[0.3] * 64)), "utf-8")
    bad.write_text("{", "utf-8")
    assert score.main([str(good)]) == 0
    assert "total" in capsys.readouterr().out
    assert score.main([str(good), str(high)]) == 1
    assert score.main([str(bad)]) == score.main([str(tmp_path / "none.json")]) == score.main([]) == 2
    assert "bad.json" in capsys.readouterr().err


def test_a_misfit_that_an_entry_states_is_compared(tmp_path, capsys):
    path = path_of("01-power-law")
    assert score.main([str(path)]) == 0
    stated = best("01-power-law").stated | {"misfit": 0.001}
    wrong = tmp_path / "wrong.json"
    wrong.write_text(json.dumps(json.loads(path.read_text("utf-8")) | stated), "utf-8")
    capsys.readouterr()
    assert score.main([str(wrong)]) == 1
    assert "limits kept; the entry states 0.1 %" in capsys.readouterr().out


def test_tables_are_entries(tmp_path):
    entry = best("01-power-law")
    rows = [f"{x:.12g},{y:.12g},{h:.12g}" for (x, y), h in zip(entry.position, entry.height, strict=True)]
    path = tmp_path / "01-power-law.csv"
    path.write_text("\n".join(["x,y,height", *rows]), "utf-8")
    assert score.read(path).height == pytest.approx(entry.height, rel=1e-12)
    path.write_text("x,y\n0,0\n", "utf-8")
    with pytest.raises(BadInput, match="the column height is missing"):
        score.read(path)
