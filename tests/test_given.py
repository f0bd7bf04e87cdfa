"""Values of every kind where numbers are due: taken for what they are, or refused by name."""

import datetime
import pickle
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pint
import pytest
import xarray as xr

import metafem as mf
from metafem._given import Names, shown, unit_of
from metafem._validate import plain
from metafem.errors import named

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


def lattice(**changes):
    given = {"height": 0.1, "shape": (2, 2), "pitch": 1.5, "radius": 0.526, "material": MATERIAL}
    return mf.Surface.square_lattice(**(given | changes))


@pytest.mark.parametrize(
    "height",
    [
        U.Quantity([100, 120], "um"),
        [100 * U.um, 0.12 * U.mm],
        [100 * U.um, 0.12],
        Quantity(np.array([100.0, 120.0]), "um"),
        [Quantity(100.0, "um"), Quantity(120.0, "um")],
        xr.DataArray(U.Quantity([100.0, 120.0], "um")),
        xr.DataArray([0.1, 0.12], attrs={"units": "mm"}),
        pd.Series([0.1, 0.12], index=[7, 9]),
        np.ma.array([0.1, 0.12], mask=False),
        [Decimal("0.1"), Fraction(3, 25)],
        np.array([0.1, 0.12], dtype=object),
    ],
    ids=lambda given: type(given).__module__,
)
def test_heights_with_units_are_converted(height):
    np.testing.assert_allclose(pair(height=height).height, [0.1, 0.12], rtol=1e-15)


def test_single_quantities_are_converted():
    assert pair(radius=526 * U.um).radius.tolist() == [0.526, 0.526]
    assert mf.Material(1360 * U.kPa, 0.5 * U.dimensionless) == MATERIAL
    assert mf.Limits(Quantity(120, "um")) == mf.Limits(0.12)
    assert mf.equilibrium(pair(), load=200 * U.mN).load == pytest.approx(0.2)
    assert mf.friction_law(pair(), load=[100 * U.mN]).load.tolist() == pytest.approx([0.1])


@pytest.mark.parametrize(
    ("height", "words"),
    [
        (U.Quantity([100, 120], "N"), "height is given in 'newton'; it must be mm, or a plain number in mm"),
        ([0.1, 1 * U.N], r"height\[1\] is given in 'newton'"),
        (Quantity(np.array([1.0, 2.0]), "N"), "height is given in 'N'; it must be mm"),
        (xr.DataArray([100.0, 120.0], attrs={"units": "um"}), "height is given in 'um'; it must be mm"),
        (xr.DataArray([0.1, np.nan]), "height holds nan at entry 1"),
        (pd.Series([0.1, None]), "height holds nan at entry 1"),
        (np.ma.array([0.1, 0.2], mask=[0, 1]), "height is masked at entry 1"),
        (np.array(["2020", "2021"], dtype="M8[s]"), "height is not an array of numbers"),
        (np.array([1, 2], dtype="m8[s]"), "height is not an array of numbers"),
        ([datetime.date(2020, 1, 1), 0.1], "height is not an array of numbers"),
        ([True, 0.1], "height is not an array of numbers"),
        (np.array([True, False]), "height is not an array of numbers"),
        (["0.1", "0.2"], "height is not an array of numbers"),
        (np.array([0.1, 0.2 + 1j]), "height is not an array of numbers"),
        ([0.1, None], "height is not an array of numbers"),
        ({0.1, 0.2}, "height is not an array of numbers"),
        ([[0.1], [0.2, 0.3]], "height is not an array of numbers"),
    ],
)
def test_arrays_of_something_else_are_refused(height, words):
    with pytest.raises(mf.InvalidInput, match=words):
        pair(height=height)


@pytest.mark.parametrize(
    "value",
    [
        *(True, np.True_, 1 + 0j, np.complex128(1), "1.36", b"1", None, np.array([1.36]), 10**400),
        *(datetime.datetime(2020, 1, 1), np.datetime64("2020"), np.timedelta64(5), slice(3), []),
    ],
    ids=repr,
)
def test_numbers_that_are_none_are_refused_on_one_line(value):
    with pytest.raises(mf.InvalidInput, match=r"composite_modulus = .* is not a number") as error:
        mf.Material(value)
    assert len(str(error.value)) < 150


def test_a_unit_for_a_pure_number_is_refused():
    with pytest.raises(mf.InvalidInput, match="slope is given in 'millimeter'; it must be a number without"):
        mf.LinearLaw(3 * U.mm)
    assert mf.LinearLaw(6 * U.N / U.N).slope == 6.0


def test_a_duration_is_no_count():
    with pytest.raises(mf.InvalidInput, match=r"shape\[0\] = np.timedelta64"):
        lattice(shape=(np.timedelta64(5), 2))


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: lattice(pitch=1e-300), "pitch = 1e-300 is outside the range in which products fit"),
        (lambda: lattice(pitch=1e-150), "pitch = 1e-150 is outside the range"),
        (lambda: lattice(pitch=1e300), r"pitch = 1e\+300 is outside the range"),
        (
            lambda: lattice(pitch=1 * U.parsec),
            r"pitch = 3.*e\+19 and radius = 0.526 differ by a factor of 6e",
        ),
        (lambda: lattice(pitch=1e-20), "pitch = 1e-20 and radius = 0.526 differ"),
        (lambda: lattice(height=1e50), r"height\[0\] = 1e\+50 and radius\[0\] = 0.526 differ"),
        (lambda: pair(position=[[1e300, 0], [0, 0]]), r"position\[0, 0\] = 1e\+300 is outside the range"),
        (
            lambda: pair(position=[[0, 0], [0, 1e20]]),
            r"position\[1\] = 1e\+20 and radius\[0\] = 0.526 differ",
        ),
        (lambda: pair(position=[[0, 1e-320], [0, 0]]), r"position\[0\] and position\[1\] coincide"),
        (lambda: pair(height=[1e308, 0]), r"height\[0\] = 1e\+308 is outside the range"),
        (lambda: pair(radius=1e-320), "radius = 9.99.*e-321 is outside the range"),
        (lambda: pair(radius=[1e-25, 1]), r"radius\[1\] = 1 and radius\[0\] = 1e-25 differ"),
        (lambda: pair(block=mf.Block(1, 1, 1e30)), r"block.thickness = 1e\+30 and radius = 0.526 differ"),
        (lambda: mf.Limits(1e308), r"max_height = 1e\+308 is outside the range"),
        (lambda: mf.Material(1e-300), "composite_modulus = 1e-300 is outside the range"),
        (lambda: mf.OperatingPoints([1e-200], [1]), r"rescaled_load\[0\] = 1e-200 is outside the range"),
        (lambda: lattice(height=[]), "height has 0 numbers; it must have 4"),
        (lambda: lattice(height=[[], []]), r"height has shape \(2, 0\); it must have shape \(2, 2\)"),
    ],
)
def test_absurd_proportions_are_refused_by_name(build, words):
    with pytest.raises(mf.InvalidInput, match=words):
        build()


def test_errors_name_the_keys_of_a_file():
    names = Names({"max_height": "--highest"}, {"max_height": ("um", 0.001)})
    with (
        pytest.raises(mf.InvalidInput, match=r"^--highest = -120 um must be greater than 0 um$") as error,
        named(names),
    ):
        mf.Limits(-0.12)
    assert (error.value.key, error.value.value) == ("max_height", -0.12)
    assert error.value.must == "must be greater than 0 um"


def test_the_words_of_an_error_that_has_been_in_another_process_are_the_same():
    with pytest.raises(mf.InvalidInput) as error:
        mf.Limits(0.1, min_height=0.2)
    copy = pickle.loads(pickle.dumps(error.value))
    assert str(copy) == str(error.value) == "min_height = 0.2 must be below max_height = 0.1"
    assert str(copy.within("limits")) == "limits.min_height = 0.2 must be below limits.max_height = 0.1"


def test_names_know_their_units():
    assert [unit_of(name) for name in ("height[3]", "part.alignment_height", "slope")] == ["mm", "mm", "1"]


def test_any_value_is_shown_on_one_line():
    class Rude:
        def __repr__(self):
            raise ValueError

    assert shown(Rude()) == "a Rude"
    with pytest.raises(mf.InvalidInput, match="an int is not a number"):
        mf.Material(10**5000)
    assert shown("a\nb\x85") == r"'a\nb\x85'"
    assert len(shown("x" * 10**6)) == 60
    assert plain("slope", 3) == 3
