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


def pair(**changes):
    given = {"position": [[0, 0], [1.5, 0]], "height": 2 * [0.1], "radius": 0.526, "material": MATERIAL}
    return mf.Surface(**(given | changes))


def test_numbers_of_other_libraries_are_heights():
    for height in (
        xr.DataArray([0.1, 0.12], attrs={"units": "mm"}),
        pd.Series([0.1, 0.12], index=[7, 9]),
        np.ma.array([0.1, 0.12], mask=False),
        [Decimal("0.1"), Fraction(3, 25)],
        np.array([0.1, 0.12], dtype=object),
    ):
        np.testing.assert_allclose(pair(height=height).height, [0.1, 0.12], rtol=1e-15)


def test_quantities_are_refused_with_the_unit_of_the_argument():
    for name, value in (("height", U.Quantity([100, 120], "um")), ("radius", 526 * U.um)):
        with pytest.raises(mf.InvalidInput, match=r"is given in 'micrometer'; .* plain numbers in mm"):
            pair(**{name: value})
    with pytest.raises(mf.InvalidInput, match="height is not an array"):
        pair(height=[100 * U.um, 0.12])
