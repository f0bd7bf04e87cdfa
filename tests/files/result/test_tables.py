import csv
import io
from dataclasses import replace

import meshio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem.files.part.caps import with_alignment
from metafem.files.result.tables import heights_table, law_table, mould_table, read_surface, write_surface

TEMPLATE = mf.Surface.square_lattice(
    0.12, (3, 3), radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
)
DESIGN = mf.design(mf.LinearLaw(6.87), TEMPLATE)


def columns(text):
    rows = list(csv.DictReader(io.StringIO(text)))
    return {name: [row[name] for row in rows] for name in rows[0]}


def read_summits(path, radius=None):
    """Return positions, heights and radii of a table."""
    surface = read_surface(path, mf.Material(1.36), radius)
    return surface.position, surface.height, surface.radius


def test_heights_read_back(tmp_path):
    path = tmp_path / "heights.csv"
    path.write_text(heights_table(DESIGN.surface, DESIGN.sites))
    for found, kept in zip(read_summits(path), ("position", "height", "radius"), strict=True):
        np.testing.assert_allclose(found, getattr(DESIGN.surface, kept), rtol=1e-12)


def test_no_rounding_is_written():
    surface = DESIGN.surface.replaced(height=np.full(9, 0.1 + 0.047))
    assert surface.height[0] != 0.147
    for text in (
        heights_table(surface, DESIGN.sites),
        mould_table(replace(DESIGN, surface=surface)),
    ):
        assert ",0.147," in text
        assert "0000000" not in text


def test_heights_name_their_sites():
    assert columns(heights_table(DESIGN.surface, DESIGN.sites))["site"] == [
        str(site) for site in DESIGN.sites
    ]


def test_the_law_is_written():
    table = columns(law_table(DESIGN.law))
    assert list(table) == [
        "load_N", "area_mm2", "separation_mm", "rescaled_load_mm2", "rescaled_friction_mm2",
        "friction_force_N",
    ]  # fmt: skip
    for title, values in table.items():
        name = title.rpartition("_")[0]
        np.testing.assert_allclose(np.array(values, dtype=float), getattr(DESIGN.law, name), rtol=1e-12)


def test_without_friction_the_law_has_no_force():
    law = mf.friction_law(TEMPLATE.replaced(friction=None))
    assert "friction_force_N" not in columns(law_table(law))


def test_the_mould_mirrors_x_and_keeps_depth_and_radius():
    surface = DESIGN.surface
    table = columns(mould_table(DESIGN, with_alignment(surface, TEMPLATE, 0.4)))
    assert table["number"] == [str(number) for number in range(1, 14)]
    assert table["site"] == [*(str(site) for site in DESIGN.sites), "", "", "", ""]
    assert table["kind"] == ["asperity"] * 9 + ["alignment"] * 4
    x, y, depth, radius = (
        np.array(table[name], dtype=float) for name in ("x_mm", "y_mm", "depth_mm", "tool_radius_mm")
    )
    np.testing.assert_array_equal(np.column_stack([-x, y])[:9], surface.position)
    np.testing.assert_allclose(depth, [*surface.height, 0.4, 0.4, 0.4, 0.4], rtol=1e-12)
    assert set(radius) == {0.526}
    assert "-0.0" not in table["x_mm"]


def test_holes_and_summits_have_their_own_radii(tmp_path):
    radius = np.random.default_rng(0).choice([0.3, 0.526, 0.8], 9)
    mixed = replace(DESIGN, surface=DESIGN.surface.replaced(radius=radius))
    np.testing.assert_array_equal(np.array(columns(mould_table(mixed))["tool_radius_mm"], float), radius)
    path = tmp_path / "heights.csv"
    path.write_text(heights_table(mixed.surface, mixed.sites))
    np.testing.assert_array_equal(read_summits(path)[2], radius)


@given(st.lists(st.integers(1, 999_999), min_size=1, max_size=5))
def test_units_of_the_header_are_applied(tmp_path_factory, nanometres):
    path = tmp_path_factory.getbasetemp() / "units.csv"
    lines = [f"{i},{0.1 * i},{n / 1000!r},note" for i, n in enumerate(nanometres)]
    path.write_text("\n".join(["x_cm,y_mm,height_\u00b5m,remark", *lines]), encoding="utf-8")
    position, height, radius = read_summits(path, radius=0.5)
    np.testing.assert_array_equal(height, [n / 1e6 for n in nanometres])
    np.testing.assert_array_equal(position[:, 0], 10.0 * np.arange(len(nanometres)))
    np.testing.assert_array_equal(radius, 0.5)


@pytest.mark.parametrize(("text", "message"), [
    ("", "is empty"),
    ("x_mm,y_mm,height_um,radius_um\n", "no summit"),
    ("x_mm,y_mm,radius_um\n0,0,5\n", "lacks height_um: it has the columns"),
    ("x_mm,y_mm,height_um\n0,0,5\n", r'lacks radius_um: .* --radius "526 um"'),
    ("x_mm,y_mm,height,radius_um\n0,0,5,5\n", "height needs a unit"),
    ("x_mm,y_mm,height_N,radius_um\n0,0,5,5\n", "does not measure in mm"),
    ("x_mm,y_mm,height_um,height_mm\n0,0,5,5\n", "two columns"),
    ("x_mm,y_mm,height_um,radius_um\n0,0,5,5\n\n0,1,high,5\n", "line 4: height_um = 'high'"),
    ("x_mm,y_mm,height_um,radius_um\n0,0,nan,5\n", "line 2: height_um = 'nan'"),
    ("x_mm,y_mm,height_um,radius_um\n0,0,1e999,5\n", "line 2: height_um = '1e999'"),
    ("x_mm,y_mm,height_um,radius_um\n0,0,5\n", "line 2 has 3 entries"),
    ("x_mm:y_mm:height_um:radius_um\n0:0:5:5\n", "has one column, .* separated by commas or semicolons"),
    ("x_mm,y_mm,height_um,radius_um\n0,0,0,5,5\n", "line 2 has 5 entries; .* if commas are decimal"),
    ('x_mm,y_mm,height_um,radius_um\n0,0,"0,5",5\n', "'0,5' is not a finite number; if commas are dec"),
    ("x_mm;y_mm;height_um;radius_um\n0;0;1.234,5;5\n", "line 2: height_um = '1.234,5' is not a finite"),
    ("# only a remark\n", "is empty"),
    (b"x_mm,\xff\n", "UTF-8"),
])  # fmt: skip
def test_a_wrong_table_is_refused(tmp_path, text, message):
    path = tmp_path / "heights.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(mf.InvalidInput, match=message):
        read_summits(path)


@pytest.mark.parametrize(
    "text",
    [
        "x_mm;y_mm;height_um;radius_mm\n0;0;120,5;0,5\n1,5;0;94.3;0,5\n",
        "x_mm\ty_mm\theight_um\tradius_mm\n0\t0\t120,5\t0.5\n1,5\t0\t94,3\t0,5\n",
        "# cold; dry\nx_mm,y_mm,height_um,radius_mm\n  # first row\n0,0,120.5,0.5\r\n1.5,0,94.3,.5",
    ],
)
def test_tables_with_other_separators_and_decimals_are_read(tmp_path, text):
    path = tmp_path / "heights.csv"
    path.write_bytes(text.encode("utf-8-sig"))
    position, height, radius = read_summits(path)
    assert (position.tolist(), height.tolist(), radius.tolist()) == (
        [[0.0, 0.0], [1.5, 0.0]],
        [0.1205, 0.0943],
        [0.5, 0.5],
    )


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0,0,5,5\n\n# remark\n1,0,5,-5", "csv, line 5: radius_um = -5 must be greater than 0$"),
        ("0,0,5,5\n1,0,5,5\n0,0,6,5", "csv, line 2: x_mm, y_mm and .*csv, line 4: x_mm, y_mm coincide at"),
        ("0,0,5,5\n1e70,0,5,5", r"csv, line 3: x_mm, y_mm = 1e\+70 mm is outside the range"),
        ("0,0,1e30,5\n", r"csv, line 2: height_um = 1e\+30 and .*csv, line 2: radius_um = 5 differ"),
    ],
)
def test_errors_of_a_table_name_line_and_column(tmp_path, rows, message):
    path = tmp_path / "heights.csv"
    path.write_text(f"x_mm,y_mm,height_um,radius_um\n{rows}\n")
    with pytest.raises(mf.InvalidInput, match=message):
        read_surface(path, mf.Material(1.36))


def test_a_radius_beside_a_column_of_radii_is_refused(tmp_path):
    path = tmp_path / "heights.csv"
    path.write_text(heights_table(DESIGN.surface, DESIGN.sites))
    with pytest.raises(mf.InvalidInput, match="has a column radius, and --radius is given too"):
        read_summits(path, radius=0.5)


def test_the_field_file_holds_the_contacts_at_the_largest_load(tmp_path):
    design = DESIGN
    write_surface(design, tmp_path / "surface.vtu")
    mesh = meshio.read(tmp_path / "surface.vtu")
    np.testing.assert_array_equal(
        mesh.points, np.column_stack([design.surface.position, design.surface.height])
    )
    np.testing.assert_array_equal(mesh.point_data["site"], design.sites)
    # exact sums of the same numbers: rounding alone
    np.testing.assert_allclose(mesh.point_data["load"].sum(), design.law.load[-1], rtol=1e-12)
    np.testing.assert_allclose(mesh.point_data["area"].sum(), design.law.area[-1], rtol=1e-12)
    np.testing.assert_allclose(
        np.pi * mesh.point_data["contact_radius"] ** 2, mesh.point_data["area"], rtol=1e-12
    )
