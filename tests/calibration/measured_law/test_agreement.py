"""Agreement of measured laws with designs: deviations, their covariance, and the features of targets."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, MeasurementErrors, compare

ERRORS = MeasurementErrors()


@pytest.fixture(scope="module")
def template():
    return mf.Surface.square_lattice(
        0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
    )


@pytest.fixture(scope="module")
def linear(template):
    return mf.design(mf.LinearLaw(6.87), template)


def measured_on(design, load, factor=1.0, rng=None, **given):
    """Return a measured law of a design whose friction is larger by a factor, with the paper's noise."""
    surface = design.surface
    force = factor * mf.friction_law(surface, load=load).friction_force
    if rng is not None:
        load = load + rng.normal(0.0, ERRORS.load, len(load))
        force = force + ERRORS.of_friction_force(force) * rng.standard_normal(len(load))
    pair = {"material": surface.material, "friction": surface.friction}
    return MeasuredLaw(load, **{"friction_force": force} | pair | given)


@pytest.mark.parametrize("factor", [1.0, 1.04])
def test_a_common_factor_is_every_deviation_and_that_of_the_slope(linear, factor):
    found = compare(measured_on(linear, np.linspace(0.02, 0.6, 12), factor), linear)
    np.testing.assert_allclose(found.percent, 100.0 * (factor - 1.0), atol=1e-9)
    (slope,) = found.features
    assert slope.deviation == pytest.approx(factor - 1.0, abs=1e-10)
    assert slope.target == 6.87
    assert factor > 1.0 or found.verdict["chi_square"].statistic == pytest.approx(0.0, abs=1e-15)


def test_loads_with_an_unknown_contact_are_left_out_and_noted(linear):
    load = np.linspace(0.1, 0.5, 5)
    areas = np.array([mf.equilibrium(linear.surface, load=value).asperity_area for value in load])
    areas[1, 7] = np.nan
    law = MeasuredLaw(load, asperity_area=areas, material=linear.surface.material)
    found = compare(law, linear)
    assert found.point.tolist() == [0, 2, 3, 4]
    assert np.isfinite(found.normalised).all()
    assert found.notes[0].text == "the point at 0.2 N is left out: the area of a contact is unknown"


def test_deviations_have_the_stated_covariance(linear):
    """Simulated parts with drawn forces, E*, sigma and B."""
    rng, load = np.random.default_rng(1), np.linspace(0.05, 0.55, 8)
    pair = {"composite_modulus": 0.04, "shear_strength": 0.006, "area_ratio": 0.01}
    surface, deviations, slopes = linear.surface, [], []
    for _ in range(300):
        e, s, b = rng.standard_normal(3)
        # what the laboratory believes differs from what the part has
        material = mf.Material(1.36 + 0.04 * e)
        friction = mf.Friction(0.358 + 0.006 * s, 0.85 + 0.01 * b)
        law = measured_on(linear, load, rng=rng, material=material, friction=friction)
        order = np.argsort(law.load)
        found = compare(law, linear, parameters=pair)
        deviations.append(found.deviation[order])
        slopes.append(found.features[0].normalised)
    expected = compare(measured_on(linear, load), linear, parameters=pair)
    assert surface.material == mf.Material(1.36)
    ratio = np.std(deviations, axis=0, ddof=1) / expected.deviation_sd
    # four standard errors of a standard deviation of 300 draws
    np.testing.assert_allclose(ratio, 1.0, atol=4.0 / np.sqrt(600))
    assert np.std(slopes, ddof=1) == pytest.approx(1.0, abs=4.0 / np.sqrt(600))
    correlation = np.corrcoef(np.array(deviations).T)[-1, -2]
    stated = expected.covariance[-1, -2] / np.prod(expected.deviation_sd[-2:])
    assert correlation == pytest.approx(stated, abs=4.0 * (1.0 - stated**2) / np.sqrt(300))


def test_the_part_that_is_the_design_is_accepted_as_often_as_stated(linear):
    rng, load = np.random.default_rng(2), np.linspace(0.05, 0.6, 10)
    verdicts = [compare(measured_on(linear, load, rng=rng), linear).verdict for _ in range(200)]
    share = np.mean([verdict["chi_square"].probability < 0.2 for verdict in verdicts])
    assert abs(share - 0.2) < 4.0 * np.sqrt(0.2 * 0.8 / 200)
    assert np.mean([verdict.fits for verdict in verdicts]) > 0.93


def test_a_matrix_of_a_calibration_is_taken_as_it_is(linear):
    law = measured_on(linear, np.linspace(0.1, 0.6, 6))
    sd = {"shear_strength": 0.006, "area_ratio": 0.01}
    apart = compare(law, linear, parameters=sd)
    same = compare(law, linear, parameters=list(sd), covariance=np.diag([0.006**2, 0.01**2]))
    np.testing.assert_allclose(same.covariance, apart.covariance, rtol=1e-12)
    assert same.parameters == pytest.approx(sd)
    # sigma B known much better than its factors
    together = compare(law, linear, parameters=list(sd), covariance=[[3.6e-5, -8.5e-5], [-8.5e-5, 2.01e-4]])
    assert (together.deviation_sd < apart.deviation_sd).all()


def test_operating_points_are_compared_at_their_loads(template):
    design = mf.design(mf.OperatingPoints([0.144, 0.336], [0.84, 1.68]), template, limits=mf.Limits(0.27))
    law = measured_on(design, np.linspace(0.05, 0.49, 12), 1.02)
    points = compare(law, design).features
    assert [point.name for point in points] == [
        "friction at P/E* = 0.144 mm²",
        "friction at P/E* = 0.336 mm²",
    ]
    np.testing.assert_allclose([point.target for point in points], [0.84, 1.68])
    np.testing.assert_allclose([point.deviation for point in points], 0.02, rtol=2e-2)
    at_one = compare(measured_on(design, 1.36 * np.array([0.1, 0.144])), design)
    assert len(at_one.features) == 1
    assert "0.336 mm²: the measured loads P/E* = 0.1 to 0.144 mm² do not include it" in str(at_one.notes[0])


def test_the_crossover_of_two_branches_is_compared(template):
    design = mf.design(mf.BilinearLaw((7.15, 12.52), 0.0737), template)
    end = 1.36 * design.fits[-1][0].load_range[1]
    law = measured_on(design, np.linspace(0.05 * end, end, 18))
    *slopes, crossover = compare(law, design).features
    assert [feature.target for feature in slopes] == [7.15, 12.52]
    assert crossover.target == 0.0737
    assert crossover.value == pytest.approx(crossover.predicted, rel=1e-9)
    assert crossover.interval[0] < crossover.value < crossover.interval[1]
    few = compare(measured_on(design, np.linspace(0.05 * end, end, 5)), design)
    assert "crossover: 5 measured points up to" in few.notes[-1].text


def test_a_law_without_a_target_is_interpolated(linear):
    law = measured_on(linear, np.linspace(0.1, 0.6, 6))
    found = compare(law, linear.law)
    np.testing.assert_allclose(found.percent, 0.0, atol=0.1)  # of the grid of 100 loads
    assert found.features == ()


def test_loads_beyond_the_design_are_left_out_and_named(linear):
    end = float(linear.law.load[-1])
    law = measured_on(linear, np.linspace(0.1, 0.8, 8))
    load, force = np.append(law.load, [1.5 * end, 2.0 * end]), np.append(law.friction_force, [2.0, 2.5])
    found = compare(measured_on(linear, load, friction_force=force), linear)
    assert len(found.point) == (law.load <= end).sum()
    assert "points at" in found.notes[0].text
    assert "left out" in found.notes[0].text
    with pytest.raises(mf.InvalidInput, match="all measured loads exceed the largest load of the design"):
        compare(MeasuredLaw([2 * end], area=[5.0], material=law.material), linear)
    few = compare(measured_on(linear, np.array([0.2, 0.3])), linear)
    assert few.features == ()
    assert "2 measured points; a slope needs at least 3" in few.notes[0].text


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"parameters": {"radius": 0.005}}, "'radius' is unknown"),
        ({"parameters": {"composite_modulus": -1.0}}, "composite_modulus = -1 must be at least 0"),
        ({"parameters": ["area_ratio"]}, "without standard deviations need covariance"),
        ({"parameters": {"area_ratio": 1.0}, "covariance": [[1.0]]}, "must be a list of names"),
        ({"parameters": ["area_ratio", "shear_strength"], "covariance": [[1, 2], [2, 1]]}, "semidefinite"),
        ({"parameters": ["area_ratio", "shear_strength"], "covariance": [[1, 2], [1, 1]]}, "symmetric"),
        ({"parameters": ["area_ratio"], "covariance": [[1, 2], [1, 1]]}, r"must have shape \(1, 1\)"),
    ],
)
def test_errors_of_parameters_that_are_none_are_refused(linear, given, words):
    with pytest.raises(mf.InvalidInput, match=words):
        compare(measured_on(linear, np.array([0.2, 0.3])), linear, **given)


def test_other_objects_are_refused(linear):
    with pytest.raises(mf.InvalidInput, match="measured = "):
        compare(linear, linear)
    with pytest.raises(mf.InvalidInput, match="design = "):
        compare(measured_on(linear, np.array([0.2, 0.3])), linear.surface)
    area = MeasuredLaw([0.1], area=[0.5], material=linear.surface.material)
    with pytest.raises(mf.InvalidInput, match="shear_strength has no effect on a law without a Friction"):
        compare(area, linear, parameters={"shear_strength": 0.01})
