"""Specifications that are given as a text, and the keys of their problems."""

import hashlib
import pickle

import numpy as np
import pytest

import metafem as mf
from metafem.files import demo_text, parsed, read_spec
from metafem.files.reading import SPECIFICATION, TABLE
from metafem.files.specification.models import DEMOS

LINEAR = demo_text("linear")
TABLE_TARGET = LINEAR.replace('kind = "linear"', 'kind = "sampled"').replace(
    "slope = 6.87", 'file = "my laws/wanted.csv"'
)


def problems_of(text, tables=None):
    with pytest.raises(mf.InvalidInput) as caught:
        parsed(text, tables or {})
    return caught.value.problems


@pytest.mark.parametrize("name", DEMOS)
def test_a_text_is_read_as_its_file_is(tmp_path, name):
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbf" + demo_text(name).replace("\n", "\r\n").encode())
    text = path.read_bytes().decode()
    of_file, of_text = read_spec(path), parsed(text)
    assert of_text.text == of_file.text == text
    assert of_text.sha256 == of_file.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert of_text.files == of_file.files
    assert (of_text.limits, of_text.model, of_text.part) == (of_file.limits, of_file.model, of_file.part)
    np.testing.assert_array_equal(of_text.design().surface.height, of_file.design().surface.height)


def test_a_table_is_given_by_its_name(tmp_path):
    table = b"rescaled_load_mm2,rescaled_friction_mm2\n0.1,0.84\n0.3,1.68\n"
    (tmp_path / "my laws").mkdir()
    (tmp_path / "my laws" / "wanted.csv").write_bytes(table)
    (tmp_path / "a.toml").write_text(TABLE_TARGET)
    given, found = parsed(TABLE_TARGET, {"my laws/wanted.csv": table}), read_spec(tmp_path / "a.toml")
    assert given.target.rescaled_load.tolist() == [0.1, 0.3]
    assert given.files == found.files


def test_a_table_that_is_not_given_is_a_problem_of_its_key():
    (problem,) = problems_of(TABLE_TARGET, {"other.csv": b""})
    assert str(problem) == (
        "target.file = 'my laws/wanted.csv' names a table that is not loaded (loaded: other.csv)"
    )
    assert problem.key == "target.file"


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (b"", "target.file cannot be used: my laws/wanted.csv is empty"),
        (b"\xff,b\n1,2\n", "target.file cannot be used: my laws/wanted.csv: line 1 is not UTF-8"),
        (b"0" * (TABLE + 1), "target.file = 'my laws/wanted.csv' is larger than 64 MiB"),
    ],
)
def test_a_table_that_cannot_be_read_is_a_problem_of_its_key(table, words):
    (problem,) = problems_of(TABLE_TARGET, {"my laws/wanted.csv": table})
    assert str(problem).startswith(words)
    assert problem.key == "target.file"


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('max_height = "120 um"', 'max_height = "-1 um"', "limits.max_height"),
        ('max_height = "120 um"', 'max_height = "500 um"', "limits.max_height"),
        ("shape = [8, 8]", "shape = [8, true]", "lattice.shape[1]"),
        ("[friction]", "[frictoin]", "frictoin"),
        ("[limits]", "[limits", ""),
        ("[part]", '[contact]\nkind = "jkr"\nadhesion_energy = "9 mJ/m^2"\ncap = {kind = "cube"}\n[part]',
         "contact.cap.kind"),
        ("seed = 0", f"seed = {'[' * 9000}", ""),
        ("seed = 0", "seed = '\ud800'", ""),
        ("seed = 0", f"seed = {' ' * SPECIFICATION} 0", ""),
    ],
)  # fmt: skip
def test_each_problem_has_its_key(old, new, key):
    assert old in LINEAR
    (problem,) = problems_of(LINEAR.replace(old, new, 1))
    assert problem.key == key
    assert str(problem).startswith(key)
    assert "\n" not in str(problem)


@pytest.mark.parametrize(
    ("new", "words"),
    [
        ("slopes = [7.15, 12.52, 3]", "target.slopes has 3 numbers; it must have 2"),
        ("slopes = [7.15]", "target.slopes has 1 number; it must have 2"),
        (
            'slopes = [7.15, 12.52]\nload_range = ["0.02 mm^2"]',
            "target.load_range has 1 number; it must have 2",
        ),
    ],
)
def test_a_list_of_the_wrong_length_is_counted_in_numbers(new, words):
    (problem,) = problems_of(demo_text("bilinear").replace("slopes = [7.15, 12.52]", new))
    assert str(problem) == words


@pytest.mark.parametrize(
    ("keys", "radii"),
    [
        ('radius_range = ["200 um", "800 um"]', mf.RadiusRange(0.2, 0.8, 0.01)),
        ('radius_range = ["200 um", "800 um"]\nstep = "25 um"', mf.RadiusRange(0.2, 0.8, 0.025)),
    ],
)
def test_the_step_of_a_range_of_radii_is_read(keys, radii):
    assert parsed(LINEAR.replace('radius = "526 um"', "") + f"\n[tools]\n{keys}\n").tools == radii


COATED = 'radii = ["0.3 mm", "0.5 mm"]\nshear_strengths = ["0.1 MPa", "500 kPa"]\n'


@pytest.mark.parametrize(
    ("keys", "caps"),
    [
        ("", (mf.Sphere(), mf.Sphere())),
        ("[cap]\nkind = 'power'\nexponent = 4.0\n", (mf.Power(4.0), mf.Power(4.0))),
        ('caps = ["sphere", "power 4"]\n', (mf.Sphere(), mf.Power(4.0))),
    ],
)
def test_tools_have_shear_strengths(keys, caps):
    text = LINEAR.replace('radius = "526 um"', "") + "\n[contact]\nkind = 'elastic'\n"
    expected = tuple(map(mf.Tool, (0.3, 0.5), caps, (0.1, 0.5)))
    assert parsed(f"{text}\n[tools]\n{COATED}{keys}").tools == expected


@pytest.mark.parametrize(
    ("keys", "removed", "words"),
    [
        (
            'radii = ["0.3 mm"]',
            "",
            "tools.shear_strengths has 2 shear strengths for 1 radii; give one for each",
        ),
        ('radius_range = ["0.3 mm", "0.5 mm"]', "", "tools.shear_strengths needs tools.radii: one shear st"),
        (COATED, "friction", "tools.shear_strengths needs a section [friction], which states area_ratio"),
        (COATED.replace("500", "-1"), "", "tools.shear_strengths[1] = -0.001 MPa must be greater than 0"),
    ],
)
def test_shear_strengths_that_do_not_suit_are_refused(keys, removed, words):
    text = LINEAR.replace('radius = "526 um"', "")
    if removed:
        start = text.index(f"[{removed}]")
        text = text[:start] + text[text.index("[", start + 1) :]
    strengths = "" if "shear_strengths" in keys else 'shear_strengths = ["0.1 MPa", "0.5 MPa"]'
    problems = problems_of(f"{text}\n[tools]\n{keys}\n{strengths}\n")
    assert words in str(problems[0])


def test_tools_have_no_step():
    text = LINEAR.replace('radius = "526 um"', "") + '\n[tools]\nradii = ["0.3 mm"]\nstep = "10 um"\n'
    (problem,) = problems_of(text)
    assert str(problem) == "tools.step needs tools.radius_range: tools are used as they are"


def test_every_problem_is_listed_and_survives_a_process():
    with pytest.raises(mf.InvalidInput) as caught:
        parsed(LINEAR.replace('"1.5 mm"', "1.5").replace('"120 um"', "120"), name="mine.toml")
    error = caught.value
    assert [problem.key for problem in error.problems] == ["lattice.pitch", "limits.max_height"]
    assert str(error) == "\n".join(f"mine.toml: {problem}" for problem in error.problems)
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        (
            '"400 um"',
            '"200 um"',
            "part.alignment_height",
            "leave out part.alignment_height.* Or raise it; write for example",
        ),
        (
            'radius = "526 um"',
            'radius = "0.3 mm"',
            "part.alignment_height",
            "0.3 mm; .* Or lower it; write for example",
        ),
        ('width = "20 mm"', 'width = "12.5 mm"', "part.alignment_height", "leave out part.alignment_height"),
        ('length = "20 mm"', 'length = "11 mm"', "block.length", "block at least 14.6 by 14.6 mm"),
        (
            '"1.5 mm"',
            '"0.75 mm"',
            "limits.max_height",
            "overlap: .* they can be 0.157 mm high above the base plane",
        ),
    ],
)
def test_a_part_that_cannot_be_made_is_refused_by_the_key_that_mends_it(old, new, key, words):
    with pytest.raises(mf.InvalidInput, match=words) as caught:
        parsed(demo_text("operating-points").replace(old, new, 1))
    assert [problem.key for problem in caught.value.problems] == [key]


def test_the_remedies_of_a_part_work():
    text = demo_text("operating-points")
    without = text.replace('alignment_height = "400 um"', "#")
    parsed(without.replace('width = "20 mm"', 'width = "12.5 mm"', 1))
    parsed(
        text.replace('width = "20 mm"', 'width = "14.6 mm"').replace('length = "20 mm"', 'length = "14.6 mm"')
    )
    close = without.replace('"1.5 mm"', '"0.75 mm"').replace('offset = "0 um"', 'offset = "12 um"')
    parsed(close.replace('"270 um"', '"145 um"'))
    with pytest.raises(mf.InvalidInput, match=r"they can be 0\.157 mm high"):
        parsed(close.replace('"270 um"', '"147 um"'))


def test_the_section_radii_of_earlier_versions_is_read_as_tools():
    text = LINEAR.replace('radius = "526 um"', "")
    old = parsed(text + '\n[radii]\ntools = ["0.3 mm", "0.4 mm"]\nmixed = true\n')
    assert (old.tools, old.mixed) == ((0.3, 0.4), True)
    ranged = parsed(text + '\n[radii]\nrange = ["0.3 mm", "0.5 mm"]\nstep = "20 um"\n')
    assert ranged.tools == mf.RadiusRange(0.3, 0.5, 0.02)


@pytest.mark.parametrize(
    ("keys", "tools"),
    [
        ("exponent_range = [1.2, 6]", mf.PowerRange(1.2, 6.0)),
        (
            "exponent_range = [2, 3]\nexponent_step = 0.5\ncoefficient = 1",
            mf.PowerRange(2, 3, 0.5, coefficient=1.0),
        ),
    ],
)
def test_a_range_of_exponents_is_pressed_by_its_profiles(keys, tools):
    spec = parsed(f"{LINEAR}\n[tools]\n{keys}\nmixed = true\n")
    assert (spec.tools, spec.model) == (tools, mf.Independent(mf.Elastic()))


def test_caps_of_tools_are_named_beside_their_radii():
    text = LINEAR.replace('radius = "526 um"', "")
    keys = 'radii = ["300 um", "0.4 mm"]\ncaps = ["sphere", "power 4"]'
    spec = parsed(f"{text}\n[tools]\n{keys}\n")
    assert spec.tools == (mf.Tool(0.3), mf.Tool(0.4, mf.Power(4)))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ('caps = ["sphere"]', "tools.caps has 1 caps for 2 radii; give one for each"),
        ('caps = ["sphere", "ball"]', 'tools.caps[1] = "ball" must be sphere, paraboloid or power'),
        ('caps = ["sphere", "power 1"]', "exponent = 1 must be greater than 1"),
        ('caps = ["paraboloid", "power 0.5e3"]', "exponent = 500 must be"),
    ],
)
def test_wrong_caps_of_tools_are_named(keys, words):
    text = LINEAR.replace('radius = "526 um"', "") + f'\n[tools]\nradii = ["0.3 mm", "0.4 mm"]\n{keys}\n'
    (problem,) = problems_of(text)
    assert words in str(problem)


def test_tools_that_overlap_are_refused_before_the_design():
    text = LINEAR.replace('radius = "526 um"', "")
    keys = 'radii = ["0.3 mm", "2 mm"]\ncaps = ["sphere", "power 4"]'
    (problem,) = problems_of(f"{text}\n[tools]\n{keys}\n")
    assert "tools do not suit: tools: Tool(radius=2.0, cap=Power" in str(problem)
    assert "nearest sites are 1.5 mm apart" in str(problem)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("exponent_range = [1.0, 6.0]", "tools.exponent_range must increase, from above 1 to at most 32"),
        ('exponent_range = [1.2, 6.0]\ncaps = ["sphere"]', "tools.caps needs tools.radii"),
        ("exponent_range = [1.2, 6.0]\nexponent_step = 9.0", "exceeds the range"),
    ],
)
def test_wrong_ranges_of_exponents_are_named(keys, words):
    (problem,) = problems_of(f"{LINEAR}\n[tools]\n{keys}\n")
    assert words in str(problem)


def test_a_range_of_exponents_needs_the_radius_of_the_lattice():
    text = LINEAR.replace('radius = "526 um"', "") + "\n[tools]\nexponent_range = [2, 3]\n"
    (problem,) = problems_of(text)
    assert "lattice.radius is missing" in str(problem)


def test_tools_without_a_curvature_need_the_law_of_their_profiles():
    (problem,) = problems_of(f'{LINEAR}\n[tools]\nexponent_range = [2, 3]\n[contact]\nkind = "hertz"\n')
    assert "use contact = Elastic()" in str(problem)
