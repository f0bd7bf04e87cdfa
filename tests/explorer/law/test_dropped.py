"""Tables of measured points: shown with their errors, compared, and used; every other file is refused."""

import numpy as np
import pytest

from metafem.errors import InvalidInput
from metafem.explorer.answer import answered
from metafem.explorer.law.dropped import MOST, as_target, better_titles, measured_of, read_points
from metafem.explorer.law.shown import Units
from metafem.explorer.session import State
from metafem.files import demo_text
from metafem.material import Material
from metafem.surface import Friction

TEXT = demo_text("operating-points")
PAIR = Material(1.36), Friction(0.37, 0.85)
FORCES = "load_mN,friction_force_mN\n200,260\n100,120\n400,530\n"


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT), 1)


def test_forces_are_rescaled_and_shown_in_both_units(answer):
    found = read_points("m.csv", FORCES, *PAIR)
    np.testing.assert_allclose(found.load, np.array([0.1, 0.2, 0.4]) / 1.36)
    np.testing.assert_allclose(found.friction, np.array([0.12, 0.26, 0.53]) / (0.37 * 0.85))
    assert found.load_sd is None
    assert found.friction_sd is None
    units = Units(1.36, 0.37 * 0.85, True)
    assert found.data(units, None)["x"] == [0.1, 0.2, 0.4]
    assert found.data(units, answer.design)["name"].startswith("m.csv: the achieved law differs by ")


def test_error_bars_are_those_of_the_table():
    text = "load_N,friction_force_N,friction_force_sd_N\n0.1,0.12,0.01\n0.2,0.26,0.02\n"
    found = read_points("m.csv", text, *PAIR)
    assert found.load_sd is None
    np.testing.assert_allclose(found.friction_sd, np.array([0.01, 0.02]) / (0.37 * 0.85))


def test_rescaled_tables_are_read_without_a_friction():
    found = read_points("m.csv", "rescaled_load_mm2,rescaled_friction_mm2\n0.1,0.5\n0.2,1\n", PAIR[0], None)
    assert found.friction.tolist() == [0.5, 1.0]


def test_columns_that_are_not_read_are_told():
    found = read_points("m.csv", "load_N,friction_force_N,colour\n0.1,0.2,red\n", *PAIR)
    assert found.remarks == ("m.csv: the column colour is not read",)


def test_the_difference_is_the_rms_of_relative_differences(answer):
    law = answer.design.law
    pairs = zip(law.rescaled_load.tolist(), (1.1 * law.area).tolist(), strict=True)
    text = "\n".join(
        ["rescaled_load_mm2,rescaled_friction_mm2", *(f"{x!r},{y!r}" for x, y in pairs), "50,60"]
    )
    difference, near = read_points("m.csv", text, *PAIR).difference(answer.design)
    assert near == 100
    assert difference == pytest.approx(1.0 / 11.0)


def test_points_become_a_target_with_its_units(answer):
    table = {"measured": FORCES + "400,550\n0,0\n", "measured_name": "m.csv"}
    text = as_target(answered(State(TEXT, **table), 1))
    found = read_points("m.csv", table["measured"], *PAIR)
    target = answered(State(text), 2).specification.target
    np.testing.assert_allclose(target.rescaled_load, found.load[[1, 2, 3]])
    # two values at one load are replaced by their mean
    assert target.rescaled_friction[-1] == pytest.approx(0.54 / (0.37 * 0.85))
    assert ' N"' in as_target(answered(State(TEXT, newtons=True, **table), 1))
    with pytest.raises(InvalidInput, match="no measured points"):
        as_target(answer)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "m.csv is empty"),
        ("\0\1\2", "null characters"),
        ("hello", "one column"),
        ("a,b\n1,2\n", "name its columns"),
        ("load,friction_force\n1,2\n", "needs a unit"),
        ("load_N,friction_force_kg\n1,2\n", "kg"),
        ("load_N,friction_force_N\n", "no measured point"),
        ("load_N,friction_force_N\n0.1,nan\n", "is not a finite number"),
        ("load_N,friction_force_N\n0.1,many\n", "is not a finite number"),
        ("load_N,friction_force_N\n0.1\n", "entries"),
        ("load_N,friction_force_N\n" + "".join(f"{i},{i}\n" for i in range(1, MOST + 2)), "at most 2,000"),
        ("<html><body>no</body></html>", "m.csv"),
        ("rescaled_load_mm2,rescaled_friction\n1,2\n", "m.csv"),
    ],
)
def test_files_of_every_wrong_kind_are_refused_by_their_name(text, words):
    with pytest.raises(InvalidInput, match=words) as raised:
        read_points("m.csv", text, *PAIR)
    assert "m.csv" in str(raised.value)
    assert "dropped.csv" not in str(raised.value)
    assert "/tmp" not in str(raised.value)


def test_forces_without_a_friction_say_what_is_missing():
    with pytest.raises(InvalidInput, match=r"state them in the section \[friction\]"):
        read_points("m.csv", FORCES, PAIR[0], None)


def test_points_are_read_again_only_where_they_or_the_material_pair_changed(answer):
    shown = answered(State(TEXT, measured=FORCES, measured_name="m.csv"), 2, answer)
    assert measured_of(answer) is None
    points = measured_of(shown)
    assert len(points.data(Units(), shown.design)["x"]) == 3
    changed = State(TEXT.replace("0.84", "0.85"), measured=FORCES, measured_name="m.csv")
    assert measured_of(answered(changed, 3)) is points
    with pytest.raises(InvalidInput, match=r"m\.csv"):
        measured_of(answered(State(TEXT, measured="x", measured_name="m.csv"), 4, answer))


def test_columns_that_are_not_known_are_named_as_they_would_be_read():
    with pytest.raises(InvalidInput, match="Do you mean friction_force_N instead of friction_N"):
        read_points("m.csv", "load_N,friction_N\n0.1,0.12\n", *PAIR)
    assert better_titles(["P [mN]", "contact area (mm²)"]) == {
        "P [mN]": "load_mN",
        "contact area (mm²)": "area_mm²",
    }
    assert better_titles(["load_N", "friction_force_mN", "temperature", ""]) == {}


@pytest.mark.parametrize(
    "header",
    [
        "Load [mN],Friction force [mN],Friction force SD [mN]",
        "Normal force (mN),Friction (mN),Friction force sd (mN)",
        "P [mN];F [mN];friction_force_sd_mN",
    ],
)
def test_labels_with_their_unit_are_column_names(header):
    text = f"{header}\n200,260,1\n100,120,2\n"
    found = read_points("m.csv", text.replace(",", ";") if ";" in header else text, *PAIR)
    np.testing.assert_allclose(found.load, np.array([0.1, 0.2]) / 1.36)
    np.testing.assert_allclose(found.friction_sd, np.array([0.002, 0.001]) / (0.37 * 0.85))
    assert found.remarks == ()


def test_labels_of_rescaled_columns_are_read():
    found = read_points("m.csv", "Rescaled load [mm²],Rescaled friction [mm^2]\n0.1,0.5\n0.2,1\n", *PAIR)
    assert found.friction.tolist() == [0.5, 1.0]
