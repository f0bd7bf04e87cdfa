"""Slopes of exponential densities: those that a contact law does not reach are refused."""

import pytest

import metafem as mf

TEMPLATE = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))


def designed(target, exponent, coefficient=0.3):
    model = mf.Independent(contact=mf.PowerCap(exponent, coefficient))
    return mf.design(target, TEMPLATE, model, mf.Limits(0.12))


@pytest.mark.parametrize("target", [mf.LinearLaw(6.87), mf.BilinearLaw((6.87, 9.0), 0.01)])
def test_cones_have_one_slope_at_all_heights(target):
    """A cone f = c rho has the area pi a^2 and, by Sneddon, the load E* (pi/2) c a^2."""
    with pytest.raises(mf.Infeasible, match=f"is above {2.0 / 0.3:.6g}, the largest") as refused:
        designed(target, 1.0)
    assert refused.value.nearest is None


def test_the_nearest_slope_of_nearly_conical_caps_can_be_designed():
    with pytest.raises(mf.Infeasible, match="choose another contact law") as refused:
        designed(mf.LinearLaw(1e3), 1.1)
    nearest = refused.value.nearest
    assert 50.0 < nearest.slope < 1e3
    assert designed(nearest, 1.1).surface.count == 16
