"""Numbers of other libraries are taken for what they are."""

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pint
import pytest
import xarray as xr

import metafem as mf

U = pint.UnitRegistry()
MATERIAL = mf.Material(1.36)


class Quantity:
    """A quantity with the attributes of astropy's."""

    def __init__(self, value, unit):
        self.value, self.unit = value, unit

    def to(self, unit):
        if (self.unit, unit) != ("um", "mm"):
            raise RuntimeError("no conversion")
        return Quantity(self.value / 1000.0, unit)


def pair(**changes):
    given = {"position": [[0, 0], [1.5, 0]], "height": 2 * [0.1], "radius": 0.526, "material": MATERIAL}
    return mf.Surface(**(given | changes))


def test_heights_with_units_are_converted():
    for height in (
        U.Quantity([100, 120], "um"),
        [100 * U.um, 0.12],
        Quantity(np.array([100.0, 120.0]), "um"),
        [Quantity(100.0, "um"), Quantity(120.0, "um")],
        xr.DataArray(U.Quantity([100.0, 120.0], "um")),
        xr.DataArray([0.1, 0.12], attrs={"units": "mm"}),
        pd.Series([0.1, 0.12], index=[7, 9]),
        np.ma.array([0.1, 0.12], mask=False),
        [Decimal("0.1"), Fraction(3, 25)],
        np.array([0.1, 0.12], dtype=object),
    ):
        np.testing.assert_allclose(pair(height=height).height, [0.1, 0.12], rtol=1e-15)
    with pytest.raises(mf.InvalidInput, match="height is given in 'N'"):
        pair(height=Quantity(np.array([1.0, 2.0]), "N"))


def test_single_quantities_are_converted():
    assert pair(radius=526 * U.um).radius.tolist() == [0.526, 0.526]
    assert mf.Material(1360 * U.kPa, 0.5 * U.dimensionless) == MATERIAL
    assert mf.Limits(Quantity(120, "um")) == mf.Limits(0.12)
    assert mf.LinearLaw(6 * U.N / U.N).slope == 6.0
    assert mf.equilibrium(pair(), load=200 * U.mN).load == pytest.approx(0.2)
    assert mf.friction_law(pair(), load=[100 * U.mN]).load.tolist() == pytest.approx([0.1])
