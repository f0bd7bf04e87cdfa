"""The contacts at several loads between which the page moves, and the loads at which the sites touch."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.surface import contact_data as module
from metafem.explorer.surface.contact_data import INTERVALS, press_data
from metafem.files import demo_text, parsed

# Largest error of the interpolated radii over the largest radius, see `INTERVALS`.
MODELS = {
    "independent": (mf.Independent(), 0.012),
    "layer": (mf.Interacting(substrate=mf.BondedLayer()), 0.04),
}


@pytest.fixture(scope="module")
def design():
    return parsed(demo_text("operating-points"), {}).design()


def under(design, model):
    return replace(design, law=mf.friction_law(design.surface, model))


def column(design, data, name):
    return np.array([state[name] for state in data["states"]], dtype=float)[:, design.sites]


@pytest.mark.parametrize(("model", "error"), MODELS.values(), ids=MODELS)
def test_straight_lines_between_the_states_are_close_to_the_contacts(design, model, error):
    design = under(design, model)
    data = press_data(design)
    loads = [state["load"] for state in data["states"]]
    assert len(loads) == INTERVALS + 1
    np.testing.assert_allclose([loads[0], loads[-1]], design.law.rescaled_load[[0, -1]], rtol=1e-5)
    area = column(design, data, "area")
    entry = np.array([np.inf if load is None else load for load in data["entry"]])[design.sites]
    worst = 0.0
    for k, load in enumerate(0.5 * (np.array(loads[1:]) + loads[:-1])):
        start = np.where(area[k] > 0.0, loads[k], np.clip(entry, loads[k], load))
        between = area[k] + (area[k + 1] - area[k]) * (load - start) / (loads[k + 1] - start)
        found = mf.equilibrium(design.surface, model, load=load * design.surface.material.composite_modulus)
        difference = np.sqrt(between / np.pi) - np.sqrt(found.asperity_area / np.pi)
        worst = max(worst, np.abs(difference).max())
    assert worst < error * np.sqrt(area.max() / np.pi)


def test_entry_loads_of_independent_asperities_are_those_of_the_heights(design):
    data = press_data(design)
    assert data["exact"]
    surface = design.surface
    for site, asperity in ((site, i) for i, site in enumerate(design.sites)):
        # Hertz: P/E* = 4/3 sum sqrt(R) d^(3/2) at the separation that is the height of the site
        indentation = np.maximum(surface.height - surface.height[asperity], 0.0)
        expected = 4.0 / 3.0 * np.sum(np.sqrt(surface.radius) * indentation**1.5)
        assert data["entry"][site] == pytest.approx(expected, rel=1e-5, abs=1e-12)
    assert all(data["entry"][site] is None for site in set(range(64)) - set(design.sites))


def test_entry_loads_of_interacting_asperities_lie_between_open_and_closed_states(design):
    design = under(design, mf.Interacting())
    data = press_data(design)
    assert not data["exact"]
    loads, area = [state["load"] for state in data["states"]], column(design, data, "area")
    for site, column_of_site in zip(design.sites, area.T, strict=True):
        if not column_of_site.any():
            assert data["entry"][site] is None
            continue
        first = int(np.argmax(column_of_site > 0.0))
        assert (0.0 if first == 0 else loads[first - 1]) <= data["entry"][site] <= loads[first]


def test_a_site_that_is_never_in_contact_has_no_entry_load(design):
    lower = replace(design, law=mf.friction_law(design.surface, load=np.linspace(0.01, 0.2, 5)))
    entry = np.array([data is None for data in press_data(lower)["entry"]])[design.sites]
    state = mf.equilibrium(design.surface, load=0.2)
    np.testing.assert_array_equal(entry, state.asperity_area == 0.0)
    interacting = under(design, mf.MeanField())
    interacting = replace(interacting, law=mf.friction_law(design.surface, mf.MeanField(), load=[0.01, 0.2]))
    assert None in [press_data(interacting)["entry"][site] for site in design.sites]


def test_large_and_slow_surfaces_have_fewer_states(design, monkeypatch):
    monkeypatch.setattr(module, "MOST_VALUES", 8 * 2 * 64)
    assert len(press_data(design)["states"]) == 9
    monkeypatch.setattr(module, "LONGEST", 0.0)
    loads = [state["load"] for state in press_data(design)["states"]]
    np.testing.assert_allclose(loads, design.law.rescaled_load[[0, -1]], rtol=1e-5)


def test_a_model_without_a_state_has_no_entry_loads(design, monkeypatch):
    def refused(*given):
        raise mf.InvalidInput("no load is possible")

    monkeypatch.setattr(mf.Independent, "curve", refused)
    assert press_data(design) == {"exact": False, "entry": [], "states": []}
