"""The soft cap's contact law: the frozen table, and the finite elements that made it."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from validation.finite_elements.frozen_meshes import (
    DEEP_CONTACTS,
    FOLDER,
    SOFT_CONTACTS,
    deep_caps,
    soft_cap,
)

RADIUS = 0.526
BODY = {"height": 0.2, "thickness": 7.2, "block_radius": 10.0}


@pytest.fixture
def frozen():
    return np.loadtxt(FOLDER / "soft_cap.csv", delimiter=",", skiprows=1)


def test_the_frozen_table_is_a_contact_law(frozen):
    material = mf.Material(1.36)
    indentation, load, area = frozen.T
    law = mf.TabulatedContact(indentation, 1.36 * load, area).for_material(material)
    a = np.array([0.1, 0.19, 0.35, 0.43]) * RADIUS
    # printed ratios of finite strain, and 0.2 % of the mesh
    assert_allclose(
        law.load(a, RADIUS) / mf.Hertz().load(a, RADIUS), [0.989, 0.981, 0.974, 0.974], atol=2.5e-3
    )
    # the pedestal is more compliant than a half-space: c_p P/pi, less what large strain stiffens
    assert (law.indentation(a, RADIUS) > mf.Hertz().indentation(a, RADIUS)).all()
    surface = mf.Surface.square_lattice([0.1, 0.12, 0.15, 0.13], (2, 2), radius=RADIUS, material=material)
    soft, hertz = (
        mf.friction_law(surface, mf.Independent(contact), load=[0.05, 0.1]) for contact in (law, mf.Hertz())
    )
    # the load is smaller by up to 2.7 % at a given contact radius
    assert_allclose(soft.area, hertz.area, rtol=0.027)
    assert (soft.area > hertz.area).all()


@pytest.mark.slow
def test_the_finite_elements_still_make_the_table(frozen):
    rows = [0, 6, 11]
    assert_allclose(soft_cap(SOFT_CONTACTS[rows]), frozen[rows], rtol=1e-6)


@pytest.mark.slow
def test_the_finite_elements_still_make_the_tables_of_deep_caps():
    rows = [0, 3, 5]
    assert_allclose(soft_cap(DEEP_CONTACTS[rows], 0.4), deep_caps()[0.4][rows], rtol=1e-6)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"material": mf.Material(1.36, 0.3)}, r"must have poisson_ratio = 0\.5"),
        ({"contact_radius": [0.2, 0.1, 0.3]}, "contact_radius must increase"),
        ({"contact_radius": [0.1, 0.2, 0.5]}, "contact_radius = 0.5 must lie within the cap's edge"),
    ],
)
def test_what_cannot_be_tabulated_is_refused(change, reason):
    with pytest.raises(mf.InvalidInput, match=reason):
        mf.fe.tabulated_contact(
            **{
                "contact_radius": [0.1, 0.2, 0.3],
                "radius": RADIUS,
                "material": mf.Material(1.36),
                **BODY,
                **change,
            }
        )
