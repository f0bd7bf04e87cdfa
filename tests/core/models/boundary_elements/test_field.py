"""Pressure, gap and displacement of resolved contacts."""

import numpy as np
import pytest

import metafem as mf
from metafem import drawing
from metafem import reference as exact
from tests.models.scenes import single_contact

MATERIAL = mf.Material(1.36)
MODULUS, RADIUS, CONTACT = MATERIAL.composite_modulus, 0.526, 0.2
PAIR = mf.Surface([[0.0, 0.0], [1.5, 0.4]], [0.1, 0.11], [0.526, 0.3], MATERIAL)
# The residual that a converged state keeps, of the largest indentation.
TOLERANCE = 1e-9  # that of BoundaryElements


def hertz(cells):
    """One contact of radius 0.2 mm, and the distance of each cell."""
    state, _ = single_contact(mf.Hertz(), cells)
    return state, np.hypot(state.field.x, state.field.y)


@pytest.fixture(scope="module")
def pair():
    return mf.equilibrium(PAIR, mf.BoundaryElements(0.01), load=0.1)


def test_pressure_and_displacement_converge_to_hertzs():
    counts = np.array([12, 24, 48])
    peak = 2.0 * CONTACT / (np.pi * RADIUS)
    pressure, displacement = [], []
    for cells in counts:
        state, r = hertz(cells)
        field = state.field
        inner, outer = r < 0.8 * CONTACT, r > 1.04 * CONTACT
        found = field.pressure[inner] / MODULUS - exact.hertz_pressure(r[inner], CONTACT, RADIUS)
        pressure.append(np.abs(found).max() / peak)
        found = field.displacement[outer] / exact.hertz_displacement(r[outer], CONTACT, RADIUS) - 1.0
        displacement.append(np.abs(found).max())
        assert inner.sum() > 0.6 * np.pi * cells**2
        assert (field.pressure[r > CONTACT + field.cell] == 0.0).all()
    # cells hold means, and the load errs by 0.12/n^2: the second order
    for error in (pressure, displacement):
        assert -np.polyfit(np.log(counts), np.log(error), 1)[0] > 1.9
        assert error[-1] < 2e-4


def test_complementarity_and_equilibrium(pair):
    field = pair.field
    closed = field.pressure > 0.0
    depth = (pair.asperity_area / (np.pi * PAIR.radius)).max()
    assert (field.pressure >= 0.0).all()
    assert field.gap.min() >= -TOLERANCE * depth
    assert np.abs(field.gap[closed]).max() <= TOLERANCE * depth
    assert field.cell**2 * field.pressure.sum() == pytest.approx(pair.load, rel=1e-12)
    np.testing.assert_allclose(field.displacement + field.undeformed_gap, field.gap, atol=1e-15)


def test_cells_are_where_the_asperities_are(pair):
    field = pair.field
    assert set(field.patch) == {0, 1}
    middle = field.corner + 0.5 * field.cell * (field.shape - 1)
    of_patch = np.abs(middle[:, None, 0] - PAIR.position[:, 0]).argmin(axis=1)
    owner = of_patch[field.patch]
    assert len(owner) == len(field.x) == field.shape.prod(axis=1).sum()
    for k in range(2):
        p = field.pressure[owner == k]
        assert field.cell**2 * p.sum() == pytest.approx(pair.asperity_load[k], rel=1e-12)
        centre = [(p * values[owner == k]).sum() / p.sum() for values in (field.x, field.y)]
        # the neighbour's field P/(pi E* r) moves the contact down its slope, R times as far; to second order
        apart = PAIR.position[k] - PAIR.position[1 - k]
        slope = pair.asperity_load[1 - k] / (np.pi * MODULUS * (apart @ apart) ** 1.5) * apart
        shift = PAIR.radius[k] * slope
        np.testing.assert_allclose(centre - PAIR.position[k], shift, atol=0.1 * np.linalg.norm(shift))


def test_states_with_fields_are_the_same_to_the_bit_in_every_run(pair):
    again = mf.equilibrium(PAIR, mf.BoundaryElements(0.01), load=0.1)
    assert again == pair
    np.testing.assert_array_equal(again.field.pressure, pair.field.pressure)
    assert "0.01 mm in 2 patches" in repr(pair.field)


def test_an_open_surface_has_no_cells():
    state = mf.equilibrium(PAIR, mf.BoundaryElements(0.01), load=0.0)
    assert state.area == state.load == state.model_error == 0.0
    with pytest.raises(mf.InvalidInput):
        _ = state.field


def test_the_picture_shows_each_patch_to_scale(pair):
    ax = drawing.new_figure(4.0, 4.0).add_subplot()
    assert pair.field.plot(ax) is ax
    assert len(ax.images) == 2
    for image, corner, shape in zip(ax.images, pair.field.corner, pair.field.shape, strict=True):
        low_x, high_x, low_y, high_y = image.get_extent()
        np.testing.assert_allclose([low_x, low_y], corner - 0.005, rtol=1e-12)
        np.testing.assert_allclose([high_x - low_x, high_y - low_y], 0.01 * shape, rtol=1e-9)
    assert ax.images[0].get_array().max() <= ax.images[0].norm.vmax
