"""The data of the pictures of the surface: heights, caps, contacts, and edits of sites."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.caps import Caps
from metafem.explorer import contact_data as module
from metafem.explorer.answer import Answer, answered
from metafem.explorer.contact_data import INTERVALS, contact_data, press_data
from metafem.explorer.history import State
from metafem.explorer.surface_data import (
    DECIMALS,
    asked_sites,
    cap_data,
    edited,
    kept_height,
    kind_of_cap,
    layout_data,
    site_data,
    typed_height,
    with_sites,
)
from metafem.explorer.table import with_values
from metafem.files import demo_text
from tests.explorer.scenes import changed

TEXT = demo_text("operating-points")
TABLE = State(TEXT).table
LOAD, MODULUS, RADIUS = 0.3, 1.36, 0.526


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT), 1)


@pytest.fixture(scope="module")
def design(answer):
    return answer.design


def test_heights_stand_at_their_sites(answer, design):
    data, layout = site_data(answer), layout_data(design)
    heights = np.array([np.nan if each is None else each for each in data["height"]])
    assert np.flatnonzero(np.isfinite(heights)).tolist() == sorted(design.sites)
    # half of the last decimal that is sent
    np.testing.assert_allclose(heights[design.sites], 1e3 * design.surface.height, atol=0.005)
    assert data["limits"] == [0.0, 270.0]
    assert (data["radius"], data["modulus"]) == (RADIUS, MODULUS)
    assert data["loads"] == design.law.rescaled_load[[0, -1]].tolist()
    assert (data["number"], data["message"], data["old"]) == (1, "", False)
    np.testing.assert_allclose([layout["x"], layout["y"]], design.template.position.T, atol=5e-5)
    assert layout["spacing"] == pytest.approx(1.5, rel=1e-12)
    assert layout["block"] == [20.0, 20.0, 7.2]
    single = {"lattice.shape": [1, 1], "part": None, "block": None, "limits.height_step": None}
    alone = answered(State(changed(demo_text("linear"), with_values, single)), 1).design
    assert (layout_data(alone)["spacing"], layout_data(alone)["block"]) == (4 * RADIUS, None)


def test_messages_tell_of_old_surfaces_and_of_kept_sites(answer):
    broken = answered(State(TEXT.replace("1.36 MPa", "1.36 mm")), 2, answer)
    assert site_data(broken)["old"]
    assert site_data(broken)["height"] == site_data(answer)["height"]
    for text, value in (
        (with_sites(TABLE, {3: "400 um"}), "400 um"),
        (with_sites(TABLE, dict.fromkeys(range(64), "200 um")), "121 %"),
        (with_sites(TABLE, {}, empty=range(1, 64)), "law states the reason"),
    ):
        assert value in site_data(answered(State("").edited(text), 2, answer))["message"]
    state = State(changed(TEXT, with_sites, {7: "100 um", 80: "1 um"}, [5, 99]))
    data = site_data(Answer(3, state, answer.specification, answer.design))
    assert (data["empty"], data["pinned"]) == ([5], {"7": "100 um"})
    assert site_data(answered(State("nothing"), 1)).keys() == {"number", "message", "old"}


def test_sites_are_kept_emptied_and_released(design):
    def asked(action, sites, height="", table=TABLE):
        return asked_sites(edited(table, design, {"action": action, "sites": sites, "height": height}))

    table = with_sites(with_sites(TABLE, {12: "120.5 um", 9: "0.15 mm"}), {}, empty=[3])
    sites = {"empty": [4], "pinned": [10, 13], "heights": ["0.15 mm", "120.5 um"]}
    assert table == {**TABLE, "sites": sites}
    assert (asked_sites(table).pinned, asked_sites(table).empty) == ({9: "0.15 mm", 12: "120.5 um"}, {3})
    site = int(design.sites[0])
    assert asked("pin", [site]).pinned == {site: kept_height(design, site)}
    assert asked("pin", [3, 4], " 120,5 ").pinned == {3: "120.5 um", 4: "120.5 um"}
    assert typed_height("0.12 mm") == "0.12 mm"
    assert asked("pin", [3], "90", table).empty == set()
    assert asked("empty", [9], table=table).pinned == {12: "120.5 um"}
    assert asked("release", [3, 9, 12], table=table) == asked_sites(TABLE)
    released = edited(table, design, {"action": "release", "sites": [3, 9, 12], "height": ""})
    assert "sites" not in released
    for each, height in zip(design.sites.tolist(), design.surface.height, strict=True):
        number, unit = kept_height(design, each).split()
        assert (unit, abs(float(number) - 1e3 * height) <= 0.1) == ("um", True)
        assert float(number) <= 1e3 * design.limits.max_height
    free = next(each for each in range(64) if each not in design.sites)
    assert kept_height(design, free) is None
    for damaged in ("sites = 3", "[sites]\nempty = 'all'", "[sites]\npinned = [1, 2]", "[sites"):
        found = asked_sites(State(damaged).known)
        assert (found.empty, found.pinned) == (set(), {})


def surface_of(cap, radius=0.5):
    return mf.Surface([[0.0, 0.0], [2.0, 0.0]], [0.1, 0.12], radius, mf.Material(1.36), cap=cap)


def test_meridians_lie_on_their_caps():
    profile = mf.Profile([[0.0, 0.2, 0.5], [0.0, 0.03, 0.3]])
    for cap in (mf.Sphere(), mf.Paraboloid(), mf.Power(4.0), profile):
        (data,) = cap_data(surface_of(cap), 0.12)
        scale = 0.5 if data["scaled"] else 1.0
        across, depth = scale * np.array(data["across"]), scale * np.array(data["depth"])
        assert (across[0], depth[0], depth[-1]) == (0.0, 0.0, pytest.approx(0.12, rel=1e-5))
        # half of the last decimal that is sent, of both lengths; no cap here is steeper than 45 degrees
        np.testing.assert_allclose(cap.depth_at(across, 0.5), depth, atol=10.0**-DECIMALS)
    (data,) = cap_data(surface_of(mf.Sphere()), 0.9)
    assert (data["across"][-1], data["depth"][-1]) == (1.0, 1.0)
    assert cap_data(surface_of(mf.Sphere()), -0.1)[0]["depth"][-1] > 0.0
    mixed = surface_of(Caps.of([mf.Power(4.0), mf.Sphere()]), [0.5, 0.2])
    assert kind_of_cap(mixed).tolist() == [0, 1]
    assert [each["depth"][-1] for each in cap_data(mixed, 0.12)] == pytest.approx([0.24, 0.6])


def column(design, values):
    return np.array([values[site] for site in design.sites], dtype=float)


def test_the_contacts_are_those_of_hertz(design):
    data, surface = contact_data(design, LOAD), design.surface
    radius, force = column(design, data["radius"]), column(design, data["force"])
    indentation = np.maximum(surface.height - data["separation"] / 1e3, 0.0)
    # half of the last decimal that is sent
    np.testing.assert_allclose(radius, np.sqrt(RADIUS * indentation), atol=5e-5)
    assert force.sum() / 1e3 == pytest.approx(LOAD * MODULUS, abs=len(force) * 5e-7)
    # p = 4 E* a / (3 pi R)
    pressure = 4.0 * MODULUS * radius / (3.0 * np.pi * RADIUS)
    np.testing.assert_allclose(column(design, data["pressure"]), pressure, atol=2e-4)
    assert data["load"] == pytest.approx(LOAD, rel=1e-9)
    assert contact_data(design, None)["load"] == pytest.approx(design.law.rescaled_load[-1], rel=1e-9)


def test_the_sensitivity_is_that_of_the_friction(design):
    layer = mf.Interacting(substrate=mf.BondedLayer())
    for model in (mf.Independent(), layer):
        law = mf.friction_law(design.surface, model, load=[0.1, 0.6])
        data = contact_data(replace(design, law=law), LOAD, sensitive=True)
        surface, i = design.surface, int(np.argmax(design.surface.height))
        step, area = 1e-4, []
        for sign in (-1.0, 1.0):
            height = surface.height.copy()
            height[i] += sign * step
            area.append(mf.equilibrium(surface.replaced(height=height), model, load=LOAD * MODULUS).area)
        expected = 100.0 * (area[1] - area[0]) / (2e3 * step) / np.mean(area)
        # central differences are off by the square of the step
        assert column(design, data["sensitivity"])[i] == pytest.approx(expected, rel=1e-3)
        assert data["note"] == ""
    law = mf.friction_law(design.surface, mf.Automatic(tolerance=0.1), load=[0.1])
    assert contact_data(replace(design, law=law), LOAD, sensitive=True)["note"]


def test_the_states_of_a_press_and_the_loads_at_which_sites_touch(design, monkeypatch):
    data, surface = press_data(design), design.surface
    loads = [state["load"] for state in data["states"]]
    assert (data["exact"], len(loads)) == (True, INTERVALS + 1)
    np.testing.assert_allclose([loads[0], loads[-1]], design.law.rescaled_load[[0, -1]], rtol=1e-5)
    for site, height in zip(design.sites, surface.height, strict=True):
        # Hertz: P/E* = 4/3 sum sqrt(R) d^(3/2) at the separation that is the height of the site
        expected = 4.0 / 3.0 * np.sum(np.sqrt(RADIUS) * np.maximum(surface.height - height, 0.0) ** 1.5)
        assert data["entry"][site] == pytest.approx(expected, rel=1e-5, abs=1e-12)
    assert all(data["entry"][site] is None for site in set(range(64)) - set(design.sites))
    state = mf.equilibrium(surface, load=loads[3] * MODULUS)
    np.testing.assert_allclose(column(design, data["states"][3]["area"]), state.asperity_area, atol=1e-4)
    below = replace(design, law=mf.friction_law(surface, load=np.linspace(0.01, 0.2, 5)))
    never = [load is None for load in press_data(below)["entry"]]
    touching = mf.equilibrium(surface, load=0.2).asperity_area
    np.testing.assert_array_equal(np.array(never)[design.sites], touching == 0.0)
    monkeypatch.setattr(module, "MOST_VALUES", 8 * 2 * 64)
    assert len(press_data(design)["states"]) == 9
    monkeypatch.setattr(module, "LONGEST", 0.0)
    assert len(press_data(design)["states"]) == 2
    coupled = replace(design, law=mf.friction_law(surface, mf.Interacting(), load=[0.05, 0.2, 0.6]))
    found = press_data(coupled)
    low, high = (column(design, state["area"]) for state in found["states"])
    assert not found["exact"]
    for site, before, after in zip(design.sites, low, high, strict=True):
        entry, (first, last) = found["entry"][site], [state["load"] for state in found["states"]]
        if after == 0.0:
            assert entry is None
        else:
            assert 0.0 <= entry <= first if before > 0.0 else first <= entry <= last

    def refused(*given):
        raise mf.InvalidInput("no load is possible")

    monkeypatch.setattr(mf.Independent, "curve", refused)
    assert press_data(design) == {"exact": False, "entry": [], "states": []}
