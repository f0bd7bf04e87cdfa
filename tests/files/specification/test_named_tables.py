"""A target law from a table."""

import tomllib

import numpy as np
import pytest

import metafem as mf
from metafem.files import parsed
from metafem.files.specification.models import demo_text

REST = demo_text("linear").split("[material]")[1].replace('height_step = "6 um"', "")


def written(folder, target, table=None):
    if table is not None:
        (folder / "wanted.csv").write_text(table, encoding="utf-8")
    path = folder / "spec.toml"
    path.write_text(f"[target]\n{target}\n[material]{REST}", encoding="utf-8")
    return path


def test_forces_of_a_table_are_rescaled(tmp_path):
    table = "load_mN,friction_force_N,weight,remark\n100,0.17,1,a\n200,0.31,2,b\n"
    target = mf.read_spec(written(tmp_path, 'kind = "sampled"\nfile = "wanted.csv"', table)).target
    np.testing.assert_allclose(target.rescaled_load, np.array([0.1, 0.2]) / 1.36, rtol=1e-14)
    np.testing.assert_array_equal(target.weight, [1.0, 2.0])


def test_error_bars_of_a_measured_law_become_relative_errors(tmp_path):
    """As `metafem compare` reads them: in any order of the loads, which may be repeated."""
    table = "load_mN,friction_force_mN,friction_force_sd_mN,load_sd_mN\n200,320,6.4,2\n100,160,6.4,1\n"
    kind = 'kind = "sampled"\nfile = "wanted.csv"'
    target = mf.read_spec(written(tmp_path, kind, table)).target
    np.testing.assert_allclose(target.rescaled_load, np.array([0.1, 0.2]) / 1.36, rtol=1e-14)
    # proportional, so that 1 % of the load is 1 % of the friction
    np.testing.assert_allclose(
        target.relative_error, [np.hypot(0.04, 0.01), np.hypot(0.02, 0.01)], rtol=1e-12
    )
    again = "load_mN,friction_force_mN,friction_force_sd_mN\n100,150,6\n200,320,6.4\n100,170,6.8\n"
    mean = mf.read_spec(written(tmp_path, kind, again)).target
    np.testing.assert_allclose(mean.rescaled_friction, target.rescaled_friction, rtol=1e-12)
    np.testing.assert_allclose(mean.relative_error, [0.04 / np.sqrt(2.0), 0.02], rtol=1e-12)


def test_repeated_loads_weigh_as_often_as_they_were_measured(tmp_path):
    table = "load_mN,friction_force_mN\n200,320\n100,150\n200,330\n200,340\n"
    target = mf.read_spec(written(tmp_path, 'kind = "sampled"\nfile = "wanted.csv"', table)).target
    assert target.weight.tolist() == [1.0, 3.0]


def test_measured_areas_are_the_rescaled_friction(tmp_path):
    table = "load_mN,area_mm2,area_sd_mm2\n136,0.8,0.008\n272,1.5,0.03\n"
    target = mf.read_spec(written(tmp_path, 'kind = "sampled"\nfile = "wanted.csv"', table)).target
    np.testing.assert_allclose(target.rescaled_load, [0.1, 0.2], rtol=1e-14)
    assert target.rescaled_friction.tolist() == [0.8, 1.5]
    np.testing.assert_allclose(target.relative_error, [0.01, 0.02], rtol=1e-12)


def test_areas_of_images_are_a_target(tmp_path):
    rows = [f"{i}.tif,{100 * i},{j},{j},0,{a},0.001" for i in (1, 2) for j, a in ((1, 0.3 * i), (2, 0.5))]
    table = "\n".join(["image,load_mN,contact,x_mm,y_mm,area_mm2,area_error_mm2", *rows])
    target = mf.read_spec(written(tmp_path, 'kind = "sampled"\nfile = "wanted.csv"', table)).target
    np.testing.assert_allclose(target.rescaled_friction, [0.8, 1.1], rtol=1e-12)
    np.testing.assert_allclose(target.relative_error, np.sqrt(2e-6) / np.array([0.8, 1.1]), rtol=1e-12)


def test_columns_that_are_not_read_are_reported(tmp_path):
    path = written(
        tmp_path,
        'kind = "sampled"\nfile = "wanted.csv"',
        "load_N,friction_force_N,Bemerkung\n0.2,0.3,gut\n0.4,0.6,\n",
    )
    facts = []
    with mf.progress.listening(lambda *_: None, facts.append):
        mf.read_spec(path)
    assert [fact.rpartition("/")[2] for fact in facts] == ["wanted.csv: the column Bemerkung is not read"]


def test_decimal_commas_and_remarks_are_understood(tmp_path):
    table = "# a remark\nload_N;friction_force_N\n0,136;0,24\n0,272;0,41\n"
    target = mf.read_spec(written(tmp_path, 'kind = "sampled"\nfile = "wanted.csv"', table)).target
    np.testing.assert_allclose(target.rescaled_load, [0.1, 0.2], rtol=1e-14)


def test_rescaled_columns_keep_their_digits(tmp_path):
    table = "rescaled_load_mm2,rescaled_friction_mm2\n0.1,0.84\n0.3,1.68\n"
    target = mf.read_spec(written(tmp_path, 'kind = "sampled"\nfile = "wanted.csv"', table)).target
    assert target.rescaled_friction.tolist() == [0.84, 1.68]


@pytest.mark.parametrize(
    ("target", "table", "words"),
    [
        ('file = "none.csv"', None, "none.csv: no such file"),
        ("file = 3", None, "target.file = 3 must be a text"),
        (
            'file = "wanted.csv"',
            "load_N,other\n1,2\n",
            "has the columns load_N, other; name its columns load_N,fric",
        ),
        ('file = "wanted.csv"', "P_N,F_N\n1,2\n", "the columns P_N, F_N; .* or rescaled_load_mm2"),
        (
            'file = "wanted.csv"',
            "load_N,friction_force_N\n0,0\n1,2\n",
            "wanted.csv, line 2: load_N = 0 must be",
        ),
        ('file = "wanted.csv"', "load_N,area_sd_mm2,friction_force_N\n1,2,3\n", "area_sd_mm2 without area"),
        ('file = "wanted.csv"', "load_N,load_sd_N,area_mm2\n1,0,3\n", "line 2: load_sd_N = 0 must be gr"),
        (
            'file = "wanted.csv"',
            "load_N,load_sd_N,area_mm2\n1,2,3\n",
            "wanted.csv: the error of sample 1 is as l",
        ),
        ('file = "wanted.csv"\nload = ["1 N"]', "load_N\n1\n", "target.file and target.load both"),
    ],
)
def test_bad_tables_are_named(tmp_path, target, table, words):
    with pytest.raises(mf.InvalidInput, match=words):
        mf.read_spec(written(tmp_path, f'kind = "sampled"\n{target}', table))


@pytest.mark.parametrize(
    "name",
    [
        *(f'"{name}"' for name in ("", ".", "..", "a/", "/", " ", "a/..", "C:")),
        "'..\\'",
        *(f'"{name}"' for name in (r"a\nb.csv", r"\u0000", r"\u202e.csv")),
        f'"{"µ" * 130}.csv"',
    ],
)
def test_a_name_that_is_not_one_of_a_file_is_a_problem_of_its_key(name):
    text = f'[target]\nkind = "sampled"\nfile = {name}\n[material]{REST}'
    with pytest.raises(mf.InvalidInput) as error:
        parsed(text, {tomllib.loads(text)["target"]["file"]: SAMPLES.encode()})
    problem = str(error.value.problems[0])
    assert problem.startswith('target.file = "')
    words = '" must end with the printable name of a file, of at most 240 bytes; write for example file = '
    assert words in problem
    assert problem.isprintable()


def test_the_table_is_kept_beside_the_specification_of_the_result(tmp_path):
    table = "load_N,friction_force_N\n0.1,0.2\n0.2,0.36\n0.3,0.53\n"
    spec = mf.read_spec(written(tmp_path, 'kind = "sampled"\nfile = "wanted.csv"', table))
    result = spec.design()
    mf.save(result, tmp_path / "out", specification=spec)
    again = mf.read_spec(tmp_path / "out" / "spec.toml").design()
    np.testing.assert_array_equal(again.surface.height, result.surface.height)


def test_powers_and_branches_are_read(tmp_path):
    power = 'kind = "power"\nexponent = 1.2\nload_range = ["0.1 mm^2", "0.4 mm^2"]'
    assert mf.read_spec(written(tmp_path, power)).target.load_range == (0.1, 0.4)
    many = (
        'kind = "multilinear"\nslopes = [9.5, 7.0, 8.0]\n'
        'crossover_loads = [["0.07 mm^2", "0.18 mm^2"], "0.2 mm^2"]\nload_range = ["0.03 mm^2", "0.26 mm^2"]'
    )
    target = mf.read_spec(written(tmp_path, many)).target
    assert target.crossover_loads == ((0.07, 0.18), (0.2, 0.2))


def test_a_crossover_of_another_unit_is_named(tmp_path):
    text = 'kind = "multilinear"\nslopes = [9.5, 7.0]\ncrossover_loads = ["0.07 mm"]\n'
    with pytest.raises(mf.InvalidInput) as error:
        mf.read_spec(written(tmp_path, text + 'load_range = ["0.03 mm^2", "0.26 mm^2"]'))
    (line,) = str(error.value).splitlines()
    assert 'target.crossover_loads[0] = "0.07 mm" has the unit "mm"' in line
    assert "function" not in line


SAMPLES = "load_N,friction_force_N\n0.1,0.2\n0.2,0.36\n0.3,0.53\n"


@pytest.mark.parametrize(
    ("name", "copy"),
    [
        ("wanted.csv", "wanted.csv"),
        ("sub/w.csv", "w.csv"),
        ("../w.csv", "w.csv"),
        ("{}/w.csv", "w.csv"),
        ("law.csv", "wanted-law.csv"),
        ("sub/SPEC.toml", "wanted-SPEC.toml"),
        (".metafem-files", "wanted-metafem-files"),
        ("sub/C:w.csv", "w.csv"),
        (r"sub/..\\w.csv", "w.csv"),
        ("sub/µ \\\" 'a.csv", "µ \" 'a.csv"),
    ],
)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_a_table_from_anywhere_is_kept_so_that_the_folder_can_be_designed_again(
    tmp_path, name, copy, newline
):
    home = tmp_path / "home"
    (home / "sub").mkdir(parents=True)
    name = name.format(tmp_path)
    place = home / name.replace('\\"', '"').replace("\\\\", "\\")
    place.write_text(SAMPLES, encoding="utf-8")
    remarks = f'# as measured, not file = "other.csv"\nkind = "sampled"\nfile = "{name}"  # of June'
    path = written(home, remarks)
    path.write_bytes(path.read_bytes().replace(b"\n", newline.encode()))
    spec = mf.read_spec(path)
    (tmp_path / "out").mkdir()
    for each, content in spec.files.items():
        (tmp_path / "out" / each).write_bytes(content)
    place.unlink()
    again = mf.read_spec(tmp_path / "out" / "spec.toml")
    assert again.files == spec.files
    assert again.files[copy] == SAMPLES.encode()
    assert again.target.rescaled_load.tolist() == spec.target.rescaled_load.tolist()
    before, after = spec.text.split(newline), again.text.split(newline)
    added = [line for line in after if line not in before]
    if copy == name:
        assert (spec.text, added) == (again.text, [])
    else:
        assert added[0] == f'# The design read "{name}"; {copy} is a copy of it.'
        assert added[1].endswith("# of June")
        assert [line for line in before if line not in after] == [f'file = "{name}"  # of June']


@pytest.mark.parametrize(
    "target",
    [
        """[target]\nkind = "sampled"\n'file' = '''sub/w.csv'''""",
        '[target]\nkind = "sampled"\n"file"="""\\\n   sub/w.csv"""',
        'target = {kind = "sampled", file = "sub/w.csv"}',
    ],
)
def test_other_spellings_of_a_file_are_renamed(target):
    kept = parsed(f"{target}\n[material]{REST}", {"sub/w.csv": SAMPLES.encode()}).files
    assert tomllib.loads(kept["spec.toml"].decode())["target"] == {"kind": "sampled", "file": "w.csv"}


def test_a_key_that_cannot_be_renamed_is_named():
    text = f'[target]\nkind = "sampled"\n"f\\u0069le" = "sub/w.csv"\n[material]{REST}'
    with pytest.raises(mf.InvalidInput, match=r'write file = "sub/w\.csv" on a line of its own'):
        parsed(text, {"sub/w.csv": SAMPLES.encode()})
