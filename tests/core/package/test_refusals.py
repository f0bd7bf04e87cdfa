"""What materials, surfaces and numbers of any kind refuse: the argument and the value are in the message."""

import math
import pickle

import numpy as np
import pandas as pd
import pint
import pytest
import xarray as xr

import metafem as mf
from metafem._validate import unit_of
from metafem.errors import refuse_missing, shown, spoken

U = pint.UnitRegistry()
MATERIAL = mf.Material(1.36)


def material(*given):
    return lambda: mf.Material(*given)


def pair(**changes):
    given = {"position": [[0, 0], [1.5, 0]], "height": 2 * [0.1], "radius": 0.526, "material": MATERIAL}
    return lambda: mf.Surface(**(given | changes))


def lattice(**changes):
    given = {"height": 0.1, "shape": (2, 2), "pitch": 1.5, "radius": 0.526, "material": MATERIAL}
    return lambda: mf.Surface.square_lattice(**(given | changes))


REFUSALS = {
    "materials": [
        (material(0.0), "composite_modulus", "0"),
        (material(math.nan), "composite_modulus", "nan"),
        (material(1.0, 0.51), "poisson_ratio", "0.51"),
        (lambda: mf.Material.from_young(0.0, 0.5), "young_modulus", "0"),
        (lambda: mf.Material.from_young(1.0, 0.6), "poisson_ratio", "0.6"),
        (lambda: mf.Friction(-1.0), "shear_strength", "-1"),
        (lambda: mf.Friction(0.4, 87), "area_ratio", "0.85"),
        (lambda: mf.Block(20.0, 20.0, 0.0), "thickness", "0"),
        (lambda: mf.Power(4).summit_radius(1.0), "curvature", "Elastic()"),
        (lambda: mf.Profile(lambda rho: rho**4, 0.3).summit_radius(1.0), "curvature", "Elastic()"),
        (lambda: refuse_missing("no_such_package", "images", "measuring"), "metafem[images]", "measuring"),
    ],
    "surfaces": [
        (pair(position=[[0, 0, 0]]), "position", "(1, 3)"),
        (pair(position=np.zeros((0, 2))), "position", "empty"),
        (pair(position=[[0, 0], [0, 0]]), "entries 1 and 2 of position", "(0, 0)"),
        (lambda: mf.PeriodicCell(0.0, 2.0), "width", "0"),
        (pair(cell=mf.PeriodicCell(0.4, 2.0)), "cell.width", "0.526"),
        (pair(cell=mf.PeriodicCell(1.2, 2.0)), "cell.width", "1.5"),
        (pair(cell=mf.PeriodicCell(1.5, 2.0)), "entries 1 and 2", "position"),
        (pair(height=[0.1]), "height", "1"),
        (pair(height=[0.1, math.inf]), "height", "entry 2 of height = inf"),
        (pair(radius=[0.5, -0.5]), "radius[1]", "-0.5"),
        (pair(material=1.36), "material", "1.36"),
        (pair(block=7.2), "block", "7.2"),
        (lambda: pair()().perturbed(0.1, rng=-1), "rng", "-1"),
        (lambda: pair()().tilted(2.0, 0.0), "angle_x", "2"),
        (lattice(shape=8), "shape", "8"),
        (lattice(shape=(0, 8)), "shape[0]", "0"),
    ],
    "magnitudes": [
        (lattice(pitch=1e-300), "pitch", "1e-300"),
        (lattice(pitch=3e19), "pitch", "3e+19"),
        (lattice(height=1e50), "height", "1e+50"),
        (pair(position=[[0, 0], [0, 1e20]]), "position[1, 1]", "1e+20"),
        (pair(radius=[1e-25, 1]), "radius[0]", "1e-25"),
        (lambda: mf.Block(1, 1, 1e30), "thickness", "1e+30"),
        (lambda: mf.OperatingPoints([1e-200], [1]), "rescaled_load[0]", "1e-200"),
    ],
    "numbers": [
        (material([]), "composite_modulus", "single number"),
        (pair(height=[[0.1], [0.2]]), "height", "(2, 1)"),
        (pair(height=U.Quantity([100, 120], "N")), "height", "newton"),
        (pair(height=xr.DataArray([100.0, 120.0], attrs={"units": "um"})), "height", "um"),
        (pair(height=pd.Series([0.1, None])), "height", "entry 2 of height = nan"),
        (pair(height=np.ma.array([0.1, 0.2], mask=[0, 1])), "height", "masked"),
        (lambda: mf.LinearLaw(3 * U.mm), "slope", "millimeter"),
    ],
}  # fmt: skip


@pytest.mark.parametrize("border", REFUSALS)
def test_a_refusal_names_the_argument_and_its_value(border):
    for call, key, value in REFUSALS[border]:
        with pytest.raises(mf.InvalidInput) as error:
            call()
        assert spoken(key) in str(error.value)
        assert value in str(error.value)
        assert "\n" not in str(error.value)


def test_errors_travel():
    with pytest.raises(mf.InvalidInput) as error:
        mf.Limits(0.1, min_height=0.2)
    copy = pickle.loads(pickle.dumps(error.value))
    assert (str(copy), copy.key, copy.value) == (str(error.value), "min_height", 0.2)
    assert copy.within("limits").key == "limits.min_height"


def test_any_value_is_shown_on_one_line_and_names_know_their_units():
    class Rude:
        def __repr__(self):
            raise ValueError

    assert shown(Rude()) == "a Rude"
    assert shown("a\nb\x85") == r"'a\nb\x85'"
    assert len(shown("x" * 10**6)) == 60
    assert [unit_of(name) for name in ("height[3]", "part.alignment_height", "slope")] == ["mm", "mm", "1"]
