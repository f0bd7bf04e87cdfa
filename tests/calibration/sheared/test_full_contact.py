"""Shear strength from full contact: exact laws, stated errors, derivatives, and loads with open contacts."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, shear_strength
from metafem.errors import InvalidInput

SURFACE = mf.Surface.square_lattice(
    np.linspace(0.1, 0.12, 9),
    (3, 3),
    radius=0.526,
    material=mf.Material(1.36),
    friction=mf.Friction(0.37, 0.85),
    block=mf.Block(20.0, 20.0, 7.2),
)
LAYER = mf.Interacting(substrate=mf.BondedLayer())


def measured(law, **given):
    """Return the friction forces of a law as measured ones."""
    known = {"friction_force": law.friction_force, "material": law.material, "friction": law.friction}
    return MeasuredLaw(law.load, **(known | given))


@pytest.fixture(scope="module")
def law():
    return mf.friction_law(SURFACE, load=np.linspace(0.1, 0.6, 12))


@pytest.mark.parametrize("model", [None, LAYER])
def test_the_law_of_the_model_gives_its_strength(model):
    exact = mf.friction_law(SURFACE, model, load=[0.05, 0.2, 0.4, 0.3])
    found = shear_strength(measured(exact), SURFACE, 0.1, model=model)
    assert found.shear_strength == pytest.approx(0.37, rel=1e-12)
    assert found.load.tolist() == [0.2, 0.3, 0.4]
    assert found.friction == mf.Friction(found.shear_strength, 0.85)


@pytest.mark.parametrize("given", [None, mf.Independent(mf.Elastic())])
def test_caps_that_differ_give_their_strength(given):
    caps = [mf.Power(3), mf.Sphere(), mf.Power(1.5, 0.3)] * 3
    surface = SURFACE.replaced(cap=caps)
    exact = mf.friction_law(surface, mf.Independent(mf.Elastic()), load=[0.2, 0.3, 0.4])
    found = shear_strength(measured(exact), surface, 0.2, model=given)
    assert found.shear_strength == pytest.approx(0.37, rel=1e-12)
    with pytest.raises(InvalidInput, match=r"load_min = 0\.001 .* all are from 0\.\d+ on"):
        shear_strength(measured(exact), surface, 0.001, model=given)


def test_errors_of_the_modulus_and_the_ratio_are_passed_on(law):
    given = np.array([[0.04**2, 0.3 * 0.04 * 0.01], [0.3 * 0.04 * 0.01, 0.01**2]])
    exact = measured(law)
    found = shear_strength(exact, SURFACE, 0.1, covariance=given)
    step = 1e-4
    changed = [
        shear_strength(exact, SURFACE.replaced(material=mf.Material(1.36 * (1.0 + step))), 0.1),
        shear_strength(exact, SURFACE.replaced(friction=mf.Friction(0.37, 0.85 * (1.0 + step))), 0.1),
    ]
    slope = [(each.shear_strength - 0.37) / step for each in changed] / np.array([1.36, 0.85])
    assert found.covariance[2, :2] == pytest.approx(given @ slope, rel=1e-3)
    assert found.covariance[2, 2] == pytest.approx(slope @ given @ slope + found.measured_sd**2, rel=1e-3)
    assert np.array_equal(found.covariance[:2, :2], given)
    assert slope[1] == pytest.approx(-0.37 / 0.85, rel=1e-3)


def test_given_deviations_are_weights(law):
    exact = measured(law)
    force = exact.friction_force * np.where(np.arange(12) == 5, 1.5, 1.0)
    deviation = np.where(np.arange(12) == 5, 1e3, 1e-3)
    found = shear_strength(measured(law, friction_force=force, friction_force_sd=deviation), SURFACE, 0.1)
    assert found.shear_strength == pytest.approx(0.37, rel=1e-6)


def test_a_load_with_open_contacts_is_refused_and_the_first_without_named(law):
    with pytest.raises(
        InvalidInput, match=r"load_min = 0.01 is too small: \d of 9 asperities are not in contact"
    ) as error:
        shear_strength(measured(law), SURFACE, 0.01)
    named = float(str(error.value).split("all are from ")[1].split()[0])
    exact = mf.equilibrium(SURFACE, approach=0.02).load
    assert named == pytest.approx(exact, rel=1e-2)
    assert shear_strength(measured(law), SURFACE, named).shear_strength == pytest.approx(0.37)


def test_bad_input_is_named(law):
    exact = measured(law)
    without = measured(law, friction_force=None, area=np.full(12, 0.2))
    negative = measured(law, friction_force=np.linspace(-3e-3, -1e-3, 12))
    unknown = MeasuredLaw(law.load, area=law.area, friction_force=law.friction_force, material=law.material)
    for message, call, given in (
        ("law has no friction forces", (without, SURFACE, 0.1), {}),
        ("friction_force is not positive", (negative, SURFACE, 0.1), {}),
        (r"law has 1 points at load_min = 0\.6", (exact, SURFACE, 0.6), {}),
        ("must be symmetric", (exact, SURFACE, 0.1), {"covariance": [[1e-4, 1.0], [1.0, 1e-4]]}),
        (r"law = .* must be a metafem.calibration.MeasuredLaw", (law, SURFACE, 0.1), {}),
        ("the area ratio B is not known", (unknown, SURFACE.replaced(friction=None), 0.1), {}),
    ):
        with pytest.raises(InvalidInput, match=message):
            shear_strength(*call, **given)


def test_an_error_of_the_radius_cancels_that_of_the_modulus(law):
    exact = measured(law)
    square = SURFACE.radius[0] ** 2
    sd = 0.01
    both = sd**2 * np.array([[square, 1.36 * 0.526], [1.36 * 0.526, 1.36**2]])
    found = shear_strength(exact, SURFACE, 0.1, covariance=both, parameters=("radius", "composite_modulus"))
    assert found.parameters == ("radius", "composite_modulus", "shear_strength")
    alone = shear_strength(exact, SURFACE, 0.1, covariance=both[1:, 1:], parameters=("composite_modulus",))
    of_modulus = alone.covariance[1, 1] - alone.measured_sd**2
    assert 0.0 <= found.covariance[2, 2] - found.measured_sd**2 < 0.05 * of_modulus
    step = 1e-4
    larger = shear_strength(exact, SURFACE.replaced(radius=0.526 * (1.0 + step)), 0.1)
    slope = (larger.shear_strength - 0.37) / (0.526 * step)
    radius = shear_strength(exact, SURFACE, 0.1, covariance=[[0.005**2]], parameters=("radius",))
    assert radius.covariance[0, 1] == pytest.approx(0.005**2 * slope, rel=1e-3)


def test_parameters_of_calibrations_are_handed_on(law):
    names = ("radius", "composite_modulus", "area_ratio", "shear_strength")
    exact = measured(law)
    given = np.diag([0.005, 0.04, 0.01, 0.006]) ** 2
    found = shear_strength(exact, SURFACE, 0.1, covariance=given, parameters=names)
    assert found.parameters == names
    assert mf.calibration.joint_covariance(found)[0] == names
    with pytest.raises(InvalidInput, match="must be different names of composite_modulus"):
        shear_strength(exact, SURFACE, 0.1, covariance=given, parameters=("wear", *names[1:]))
    assert shear_strength(exact, SURFACE, 0.1).parameters == ("shear_strength",)
