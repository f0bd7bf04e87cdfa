"""The calibration sample under models of the whole interface."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import Sample, fit_compression
from metafem.calibration.compression.scene import cap_curve, sample_curve

RADIUS = 0.526
A = np.linspace(0.08, 0.4, 20)
AREA = math.pi * A**2
POSITION = 7.1 / math.sqrt(2.0) * np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
SAMPLE = mf.Surface(POSITION, np.full(5, 0.4), RADIUS, mf.Material(1.36), block=mf.Block(20.0, 20.0, 7.2))
LAYER = mf.Interacting(substrate=mf.BondedLayer())


def states_of(surface, model, area=AREA):
    """Loads and areas of the sample whose total areas span those of five contacts, for E* = 1.36."""
    load = 1.36 * 5.0 * 4.0 / 3.0 * (area / math.pi) ** 1.5 / RADIUS
    states = [mf.equilibrium(surface, model, load=each) for each in load]
    return load, np.array([state.asperity_area for state in states])


@pytest.mark.parametrize("cap", [mf.Hertz(), mf.SphericalCap(), mf.PowerCap(3.0)], ids=repr)
@pytest.mark.parametrize("one_by_one", [False, True])
def test_independent_caps_of_one_height_have_the_curve_of_the_cap(cap, one_by_one):
    small = AREA[:15]
    area = np.repeat(small[:, None], 5, axis=1) if one_by_one else small[:, None]
    found = sample_curve(SAMPLE_OF_ONE, mf.Independent(contact=cap), area, one_by_one).load_and_slope(area)
    alone = cap_curve(cap, RADIUS).load_and_slope(area)
    assert found[0] == pytest.approx(alone[0], rel=1e-7)
    assert found[1] == pytest.approx(alone[1], rel=1e-5)


SAMPLE_OF_ONE = mf.Surface(POSITION, np.full(5, 0.4), RADIUS, mf.Material(1.0))


@pytest.mark.parametrize(
    "model",
    [mf.Interacting(), LAYER, mf.Interacting(substrate=mf.BondedLayer(), pedestal=True), mf.MeanField()],
    ids=repr,
)
def test_the_model_of_the_data_gives_their_modulus_back(model):
    # caps so close that interaction matters: a pitch of 1.5 mm
    close = mf.Surface(
        1.5 / 7.1 * math.sqrt(2.0) * POSITION, np.full(5, 0.4), RADIUS, mf.Material(1.36),
        block=mf.Block(20.0, 20.0, 7.2),
    )  # fmt: skip
    (load, area), sample = states_of(close, model), Sample(5, model=model, surface=close)
    total, single = (fit_compression(load, each, RADIUS, sample) for each in (area.sum(axis=1), area))
    assert total.composite_modulus == pytest.approx(1.36, rel=1e-7)
    assert single.composite_modulus == pytest.approx(1.36, rel=1e-7)
    assert abs(total.adhesion_root) < 1e-8


@pytest.mark.parametrize("substrate", [mf.HalfSpace(), mf.BondedLayer()], ids=repr)
def test_adhesive_contacts_that_interact_give_w_back(substrate):
    adhesive = mf.Interacting(substrate=substrate, contact=mf.JKR(9e-6))
    load = 5.0 * (1.36 * 4.0 / 3.0 * A**3 / RADIUS - np.sqrt(8.0 * math.pi * 9e-6 * 1.36 * A**3))
    area = mf.friction_law(SAMPLE, adhesive, load=load).area
    sample = Sample(5, model=mf.Interacting(substrate=substrate), surface=SAMPLE)
    found = fit_compression(load, area, RADIUS, sample)
    # the adhesion of the fit is that of contacts far apart
    assert found.composite_modulus == pytest.approx(1.36, rel=1e-5)
    assert found.adhesion_energy == pytest.approx(9e-6, rel=3e-4)


def test_neighbours_change_the_modulus_by_their_curvature_alone():
    # order 3: 1/R_i = 1/R + sum_j P_j/(2 pi E* r^3), for equal caps P(a) = E* 4 a^3/3 (1/R + k)
    pair = mf.Surface([[0.0, 0.0], [1.5, 0.0]], [0.4, 0.4], RADIUS, mf.Material(1.0))
    area = np.array([[0.1], [0.2]])
    load, _ = sample_curve(pair, mf.Interacting(), area, False).load_and_slope(area)
    alone, _ = cap_curve(mf.Hertz(), RADIUS).load_and_slope(area)
    # the contacts move apart along the slope of the field, by R P/(pi r^2)
    distance = 1.5 + 2.0 * RADIUS * alone / (math.pi * 1.5**2)
    curvature = alone / (2.0 * math.pi * distance**3)
    assert load / alone - 1.0 == pytest.approx(RADIUS * curvature, rel=0.05)


def test_the_samples_radius_is_changed_with_the_radius():
    load, area = states_of(SAMPLE, LAYER)
    sample = Sample(5, radius_sd=0.005, model=LAYER, surface=SAMPLE)
    found = fit_compression(load, area.sum(axis=1), RADIUS, sample)
    assert found.radius_change[0] == pytest.approx(1.36 * 0.005 / RADIUS, rel=1e-3)


def test_a_taller_cap_carries_more():
    height = np.array([0.4, 0.4, 0.4, 0.4, 0.41])
    uneven = mf.Surface(POSITION, height, RADIUS, mf.Material(1.36))
    load, area = states_of(uneven, mf.Independent())
    found = fit_compression(load, area, RADIUS, Sample(5, surface=uneven))
    assert found.composite_modulus == pytest.approx(1.36, rel=1e-6)
    total = fit_compression(load, area.sum(axis=1), RADIUS, Sample(5, surface=uneven))
    assert total.composite_modulus == pytest.approx(1.36, rel=1e-4)
    assert total.verdict["chi_square"].statistic < 1e-3
    even = fit_compression(load, area.sum(axis=1), RADIUS, Sample(5))
    assert even.verdict["chi_square"].statistic > 1e3 * total.verdict["chi_square"].statistic


@pytest.mark.slow
def test_the_block_with_free_sides_is_a_model_of_the_sample():
    model = mf.Interacting(substrate=mf.fe.Block3D(cell=0.5, edge_cell=0.05))
    load, area = states_of(SAMPLE, model)
    found = fit_compression(load, area.sum(axis=1), RADIUS, Sample(5, model=model, surface=SAMPLE))
    assert found.composite_modulus == pytest.approx(1.36, rel=1e-7)


LOW = mf.Surface(POSITION, [0.4, 0.4, 0.4, 0.4, -0.5], RADIUS, mf.Material(1.36))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"contacts": 4}, "surface has 5 asperities, but contacts = 4 share the load"),
        ({"radius": 0.5}, r"surface.radius\[0\] = 0.526 differs from radius = 0.5"),
        ({"poisson_ratio": 0.4}, "poisson_ratio = 0.4 differs from that of the surface, 0.5"),
        ({"surface": 5}, "surface = 5 must be a metafem.Surface"),
        ({"model": "layer"}, "model = 'layer' must be a model"),
        (
            {"area": np.repeat(AREA[:, None], 5, axis=1), "surface": LOW},
            "surface: asperity 4 is in contact in ",
        ),
    ],
)
def test_wrong_samples_are_named(arguments, message):
    usual = {"load": AREA**1.5, "area": 5.0 * AREA, "radius": RADIUS, "contacts": 5, "surface": SAMPLE}
    given = usual | arguments
    points = [given.pop(name) for name in ("load", "area", "radius")]
    with pytest.raises(mf.InvalidInput, match=message):
        fit_compression(*points, Sample(**given))
