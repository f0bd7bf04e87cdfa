"""Resolved contacts of caps that are no paraboloids."""

import numpy as np
import pytest

import metafem as mf
from metafem.caps.shapes import sphere_profile
from metafem.models.boundary_elements import contact_areas
from metafem.models.boundary_elements.contact_areas import Contacts
from metafem.models.boundary_elements.solve import Scene
from metafem.models.boundary_elements.summits import Summits
from tests.models.interacting.dense_twin import Twin
from tests.models.scenes import lattice, scene, single_contact

RADIUS, CONTACT = 0.526, 0.2
MATERIAL = mf.Material(1.36)
RHO = np.linspace(0.0, 0.45, 80)
SPHERE = mf.AxisymmetricCap([RHO, sphere_profile(RHO, RADIUS)])
LAWS = [*(mf.PowerCap(n) for n in (1, 1.5, 3, 4, 8)), mf.SphericalCap(), SPHERE]


@pytest.mark.parametrize("law", [mf.Hertz(), *LAWS], ids=repr)
def test_one_contact_is_that_of_the_law(law):
    width = 0.5 * RADIUS if law in (mf.SphericalCap(), SPHERE) else CONTACT
    state, exact = single_contact(law, 50, contact_radius=width)
    # the cells' error at 50 per radius
    assert state.load == pytest.approx(exact.load, rel=1e-4)
    assert state.area == pytest.approx(exact.area, rel=3e-4)
    assert state.stiffness == pytest.approx(exact.stiffness, rel=5e-4)
    assert state.model.contact == law


@pytest.mark.parametrize("count", [5, 7])
@pytest.mark.parametrize("exponent", [1.2, 1.5, 8])
def test_contacts_of_few_cells_keep_the_area_of_their_law(exponent, count):
    """Their edges are not found: the pressure is steep or flat at the axis, some cells from the edge."""
    contact_radius = 0.05
    for offset in np.random.default_rng(count).random((3, 2)):
        state, exact = single_contact(mf.PowerCap(exponent), count, offset, contact_radius)
        missing = abs(state.area - exact.area) / (contact_radius / count) ** 2
        assert missing < 1.25 * (0.37 * np.pi)  # LAWFUL_ERROR


@pytest.mark.parametrize("law", [mf.PowerCap(4), mf.SphericalCap()], ids=repr)
def test_the_error_falls_as_the_square_of_the_cell(law):
    counts = np.array([12, 24, 48])
    found = [single_contact(law, n) for n in counts]
    for name, least in (("load", 1.8), ("area", 1.5)):  # the sum over the edge scatters
        errors = [abs(getattr(s, name) / getattr(e, name) - 1.0) for s, e in found]
        assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] > least


def test_areas_from_moments_hold_for_any_extra_curvature():
    surface = scene(radius=np.full(6, RADIUS))
    a = np.linspace(0.1, 0.2, 6)
    for law in (*LAWS, mf.PowerCap(2)):
        kappa = np.linspace(-0.1, 0.4, 6) * law.indentation(a, RADIUS) / a**2
        load, moment = (f(a, RADIUS, kappa) for f in (law.load, law.second_moment))
        summits = Summits.of(surface, law, 0.01)
        found = summits.areas(0.5 * moment / load / 1e-4, load / 1e-4, np.zeros(6))
        np.testing.assert_allclose(1e-4 * found, np.pi * a**2, rtol=1e-12)
        assert (summits.areas(*np.zeros((3, 6))) == 0.0).all()
        assert (summits.areas(np.zeros(6), np.ones(6), np.ones(6)) == 0.0).all()  # on one cell


def test_a_power_of_two_is_the_paraboloid():
    cells = mf.BoundaryElements(0.012), mf.BoundaryElements(0.012, contact=mf.PowerCap(2))
    hertz, power = (mf.equilibrium(scene(), model, load=0.1) for model in cells)
    assert power.area == pytest.approx(hertz.area, rel=1e-8)
    np.testing.assert_allclose(power.asperity_load, hertz.asperity_load, rtol=1e-8)
    again = mf.equilibrium(scene(), cells[1], approach=power.approach)
    assert again.load == pytest.approx(0.1, rel=1e-8)


@pytest.mark.parametrize(
    ("law", "surface"),
    [(mf.PowerCap(4), lattice(0.5 * np.ones(9))), (mf.PowerCap(1.5), scene()), (mf.SphericalCap(), scene())],
    ids=repr,
)
def test_coupled_contacts_are_those_of_order_3(law, surface):
    twin, approach = Twin(surface, law), float(law.indentation(0.18, RADIUS))
    load = twin.solve(approach=approach)[1].sum()
    state = mf.equilibrium(surface, mf.BoundaryElements(0.008, contact=law), approach=approach)
    # what is required up to a/L = 0.2
    assert state.load / 1.36 == pytest.approx(load, rel=3e-4)
    area = twin.solve(load=state.load / 1.36)[2].sum()
    assert state.area == pytest.approx(area, rel=1e-3)
    assert not any("not that of" in note.text for note in state.notes)


@pytest.mark.slow
@pytest.mark.parametrize("law", [mf.PowerCap(1.5), mf.PowerCap(4)], ids=repr)
def test_areas_from_moments_are_those_within_the_edges_on_a_slope(law, monkeypatch):
    """A neighbour's field has a slope, by which the area and the second moments change."""
    surface = scene([[0.0, 0.0], [0.7, 0.3]], [0.1, 0.1], RADIUS)
    model, approach = mf.BoundaryElements(0.003, contact=law), float(law.indentation(0.19, RADIUS))
    state = mf.equilibrium(surface, model, approach=approach)
    assert not any("not that of" in note.text for note in state.notes)
    monkeypatch.setattr(contact_areas, "OTHER_CAPS", -1.0)
    edges = mf.equilibrium(surface, model, approach=approach)
    # without the terms of the slope 1.4e-4 and 2.2e-4
    assert state.area == pytest.approx(edges.area, rel=1e-4)


def test_a_flat_summit_on_a_slope_touches_beside_its_axis():
    """At its axis the second summit does not reach the plane, by 1.4 um."""
    surface = scene([[0.0, 0.0], [0.75, 0.0]], [0.5, 0.385], RADIUS)
    areas = [
        mf.equilibrium(
            surface, mf.BoundaryElements(cell, contact=mf.PowerCap(4)), approach=0.15
        ).asperity_area
        for cell in (0.004, 0.008)
    ]
    assert areas[0][1] > 0.01
    # seven cells for the deformed one
    np.testing.assert_allclose(*areas, atol=7.0 * 0.008**2 + 7.0 * 0.004**2, rtol=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1e-6, 1e6])
@pytest.mark.parametrize("law", [mf.PowerCap(4), mf.SphericalCap()], ids=repr)
def test_units_do_not_matter(law, factor):
    pair = scene([[0.0, 0.0], [1.0, 0.3]], [0.1, 0.101], RADIUS)
    long = mf.Surface(pair.position * factor, pair.height * factor, RADIUS * factor, pair.material)
    state, scaled = (
        mf.equilibrium(surface, mf.BoundaryElements(0.008 * unit, contact=law), load=0.05 * unit**2)
        for surface, unit in ((pair, 1.0), (long, factor))
    )
    assert scaled.area == pytest.approx(state.area * factor**2, rel=1e-9)
    assert scaled.approach == pytest.approx(state.approach * factor, rel=1e-9)


def test_contacts_wider_than_the_profile_are_refused():
    law = mf.AxisymmetricCap([RHO[:30], sphere_profile(RHO[:30], RADIUS)])
    surface, model = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL), mf.BoundaryElements(0.01, contact=law)
    most = float(law.largest_indentation(RADIUS))
    assert mf.equilibrium(surface, model, approach=0.98 * most).area == pytest.approx(
        np.pi * law.contact_radius(0.98 * most, RADIUS) ** 2, rel=2e-3
    )
    with pytest.raises(mf.InvalidInput, match="exceeds"):
        mf.equilibrium(surface, model, approach=1.1 * most)
    scene_of_cells = Scene(surface, 0.01, mf.HalfSpace(), law)
    contacts = Contacts(np.ones(1), np.full(1, 1500.0), np.zeros(1, bool), np.zeros((0, 2), np.int64))
    with pytest.raises(mf.InvalidInput, match=r"has the radius 0\.2185 mm, beyond 0\.1652 mm, up to which"):
        scene_of_cells.require_extent(contacts)
