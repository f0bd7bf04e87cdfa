import hashlib
import math
import re

import numpy as np
import pytest

import metafem as mf
from metafem.files.specification.contents import tell_cost
from metafem.files.specification.models import demo_text
from tests.files.specification.wrong import LINEAR, RADIUS, WRONG


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "spec.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return mf.read_spec(path)

    return read


@pytest.mark.parametrize("name", ["linear", "bilinear"])
def test_a_demo_names_a_load_range_over_which_its_line_is_met(read, name):
    text = demo_text(name)
    assert text.count("\n# load_range = ") == 1
    assert read(text.replace("\n# load_range", "\nload_range")).design().misfit < 0.01


def test_the_linear_demo_is_the_published_surface(read):
    spec = read(LINEAR)
    template = spec.template
    assert spec.target == mf.LinearLaw(6.87)
    assert spec.limits == mf.Limits(0.12, offset=0.084, height_step=0.006, height_sd=0.0009)
    assert template.material == mf.Material(1.36, 0.5)
    assert template.friction == mf.Friction(0.358, 0.85)
    assert template.block == mf.Block(20.0, 20.0, 7.2)
    assert (template.count, set(template.radius)) == (64, {0.526})
    np.testing.assert_array_equal(np.ptp(template.position, axis=0), [10.5, 10.5])
    assert (spec.model, spec.seed, spec.part.alignment_height) == (mf.Independent(), 0, 0.4)


def test_text_and_hash_are_those_of_the_file(read):
    raw = LINEAR.replace("\n", "\r\n").encode("utf-8-sig")
    spec = read(raw)
    assert spec.text.encode() == raw
    assert spec.sha256 == hashlib.sha256(raw).hexdigest()


def test_optional_sections_may_be_left_out(read):
    required, rest = LINEAR.split("[friction]")
    lattice = rest[rest.index("[lattice]") : rest.index("[block]")]
    spec = read(required + lattice + '[limits]\nmax_height = "120 um"\n')
    assert spec.template.friction is None
    assert spec.template.block is None
    assert (spec.seed, spec.part.alignment_height, spec.hardness) == (0, None, None)


def test_a_hardness_decides_on_the_law_of_the_design(read):
    hard, soft = (read(LINEAR + f'[checks]\nhardness = "{h} MPa"\n').design() for h in (10, 0.4))
    assert hard.notes[0].text.startswith("the contacts stay elastic: the plasticity index is 0.0")
    assert soft.law.model == mf.Independent(mf.KogutEtsion(0.4))
    assert "this design is for the law KogutEtsion(hardness=0.4)" in soft.notes[0].text


def test_a_material_may_be_given_by_its_youngs_modulus(read):
    text = LINEAR.replace('composite_modulus = "1.36 MPa"', 'young_modulus = "1020 kPa"')
    assert read(text).template.material == mf.Material.from_young(1.02, 0.5)


@pytest.mark.parametrize("keys", ['composite_modulus = "1.36 MPa"\nyoung_modulus = "1.02 MPa"', ""])
def test_a_material_has_one_modulus(read, keys):
    with pytest.raises(mf.InvalidInput, match=r"material .*needs either composite_modulus or young_modulus"):
        read(LINEAR.replace('composite_modulus = "1.36 MPa"', keys))


def test_target_from_a_friction_coefficient(read):
    spec = read(LINEAR.replace("slope = 6.87", "friction_coefficient = 1.5"))
    expected = mf.LinearLaw.from_friction_coefficient(1.5, spec.template.material, spec.template.friction)
    assert spec.target == expected


def test_target_from_forces(read):
    forces = 'load = ["0.1 N", "300 mN"]\nfriction_force = ["0.2 N", "0.5 N"]'
    text = LINEAR.replace("slope = 6.87", forces).replace('kind = "linear"', 'kind = "operating-points"')
    np.testing.assert_allclose(read(text).target.rescaled_load, [0.1 / 1.36, 0.3 / 1.36], rtol=1e-12)


def test_lines_are_read_over_loads_of_either_kind(read):
    areas = 'load_range = ["0.05 mm^2", "200000 um^2"]'
    assert read(LINEAR.replace("slope = 6.87", f"slope = 6.87\n{areas}")).target == mf.LinearLaw(
        6.87, (0.05, 0.2)
    )
    forces = 'load_range = ["68 mN", "0.272 N"]'
    target = read(LINEAR.replace("slope = 6.87", f"slope = 6.87\n{forces}")).target
    assert target.load_range == pytest.approx((0.05, 0.2), rel=1e-15)
    assert target.title.endswith("slope 6.87 from 0.068 to 0.272 N")
    mu = read(LINEAR.replace("slope = 6.87", f"friction_coefficient = 1.5\n{areas}")).target
    assert mu.title.endswith("friction coefficient 1.5 from 0.068 to 0.272 N")


def test_bilinear_and_multilinear_laws_take_friction_coefficients(read):
    bilinear = demo_text("bilinear").replace("slopes = [7.15, 12.52]", "friction_coefficients = [1.2, 1.9]")
    forces = bilinear.replace('"0.0380 mm^2"', '"0.05776 N"\nload_range = ["0.03 N", "0.15 N"]')
    target = read(forces).target
    assert target.friction_coefficients == (1.2, 1.9)
    assert target.crossover_load == pytest.approx(0.038, rel=1e-15)
    assert target.title.endswith("friction coefficients 1.2 and 1.9 through the origin from 0.03 to 0.15 N")
    branches = (
        'kind = "multilinear"\nfriction_coefficients = [2, 1.5]\ncrossover_loads = [["0.1 N", "0.2 N"]]'
    )
    text = LINEAR.replace('kind = "linear"', branches).replace(
        "slope = 6.87", 'load_range = ["0.05 N", "0.4 N"]'
    )
    assert read(text).target.friction_coefficients == (2.0, 1.5)
    assert read(text).target.crossover_loads[0] == pytest.approx((0.1 / 1.36, 0.2 / 1.36), rel=1e-15)


def test_a_layout_is_read_with_its_angle(read):
    assert read(LINEAR).layout is None
    assert read(LINEAR.replace("seed = 0", "follow_law = true")).layout == mf.Layout()
    tilt = 'tilt = "0.1 deg"\ntilt_weight = 2'
    assert read(LINEAR.replace("seed = 0", tilt)).layout == mf.Layout(tilt=math.radians(0.1), tilt_weight=2.0)
    alone = tilt + "\nfollow_law = false"
    assert read(LINEAR.replace("seed = 0", alone)).layout == mf.Layout(False, math.radians(0.1), 2.0)


def test_the_errors_of_a_robust_design_are_read(read):
    assert read(LINEAR).robust is None
    errors = '[robust]\nheight_sd = "3 um"\nangle = "0.05 deg"\nradius_sd = "2 um"\n'
    assert read(LINEAR + errors).robust == mf.Tolerances(0.003, math.radians(0.05), 0.002)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("", "robust needs an error above 0 of height_sd, angle, radius_sd, position_sd"),
        ('height_sd = "0 um"', "robust needs an error above 0"),
        ('height_sd = "-3 um"', "robust.height_sd = -3 um must be at least 0 um"),
        ('angle = "50 deg"', "robust.angle = 50 deg must be at most 45 deg"),
        ('tilt = "1 deg"', "robust.tilt"),
    ],
)
def test_errors_that_a_design_cannot_use_are_named(read, keys, words):
    with pytest.raises(mf.InvalidInput, match=re.escape(words)):
        read(f"{LINEAR}[robust]\n{keys}\n")


@pytest.mark.parametrize(
    ("keys", "radii", "least"),
    [
        ('radii = ["526 um", "0.3 mm"]', (0.526, 0.3), 0.3),
        ('radius_range = ["200 um", "800 um"]\nmixed = false', mf.RadiusRange(0.2, 0.8), 0.2),
    ],
)
def test_radii_take_the_place_of_the_lattice_radius(read, keys, radii, least):
    spec = read(LINEAR.replace(RADIUS, "") + f"[tools]\n{keys}\n")
    assert (spec.tools, spec.mixed, set(spec.template.radius)) == (radii, False, {least})


@pytest.mark.parametrize("radii", [RADIUS, '[tools]\nradii = ["200 um", "526 um"]\nmixed = true'])
def test_caps_higher_than_every_radius_are_refused_before_the_design(read, radii):
    tall = LINEAR.replace('max_height = "120 um"', 'max_height = "120 mm"').replace(RADIUS, "")
    text = tall.replace("[lattice]", f"[lattice]\n{radii}") if radii == RADIUS else f"{tall}\n{radii}\n"
    with pytest.raises(
        mf.InvalidInput,
        match=r"limits\.max_height = 120 mm and limits\.offset = 84 um together exceed the radius of 526 um",
    ):
        read(text)


def test_mixed_radii_may_differ_between_asperities(read):
    kind = '[target]\nkind = "power"\nexponent = 0.645\nload_range = ["0.1 mm^2", "0.3 mm^2"]\n'
    text = kind + LINEAR[LINEAR.index("[material]") :].replace(RADIUS, "")
    result = read(text + '[tools]\nradii = ["200 um", "0.8 mm"]\nmixed = true\n').design()
    assert set(result.surface.radius) == {0.2, 0.8}


def test_a_specification_is_designed_with_its_radii_and_layout(read):
    """A slope of 4.5 is out of reach of the larger tool."""
    text = LINEAR.replace(RADIUS, "").replace("[8, 8]", "[4, 4]").replace("6.87", "4.5")
    text = text.replace("seed = 0", 'seed = 3\ntilt = "0.1 deg"')
    spec = read(text + '[radii]\ntools = ["526 um", "300 um"]\n')
    result = spec.design()
    assert result.parameters["radius"] == 0.3
    assert result.layout == mf.Layout(tilt=math.radians(0.1))
    same = mf.design(
        spec.target, spec.template, None, spec.limits, 3, spec.layout, tools=[0.3, 0.526], common_radius=True
    )
    np.testing.assert_array_equal(result.surface.height, same.surface.height)


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_specification_is_refused_by_name(read, case):
    old, new, parts = WRONG[case]
    assert old in LINEAR
    with pytest.raises(mf.InvalidInput) as error:
        read(LINEAR.replace(old, new))
    assert all(part in str(error.value) for part in parts)
    for problem in error.value.problems:
        assert problem.key or case == "truncated"
        assert str(problem).startswith(problem.key)
        assert "\n" not in str(problem)


def test_a_list_entry_is_named(read):
    text = demo_text("operating-points").replace('"0.336 mm^2"', "0.336")
    with pytest.raises(mf.InvalidInput, match=r"target\.rescaled_load\[1\] = 0.336 needs a unit"):
        read(text)


def test_points_need_both_lists(read):
    text = demo_text("operating-points").replace("rescaled_friction =", "friction_force =")
    with pytest.raises(mf.InvalidInput, match="target"):
        read(text)


@pytest.mark.parametrize("target", ["friction_coefficient = 1.5", None])
def test_forces_without_friction_are_refused(read, target):
    start, end = LINEAR.index("[friction]"), LINEAR.index("[lattice]")
    text = LINEAR[:start] + LINEAR[end:]
    forces = 'load = ["0.2 N"]\nfriction_force = ["0.3 N"]'
    if target is None:
        text = text.replace('kind = "linear"', 'kind = "operating-points"')
    with pytest.raises(mf.InvalidInput, match=r"need(s)? \[friction\]"):
        read(text.replace("slope = 6.87", target or forces))


def test_all_problems_are_reported_one_a_line(read):
    text = LINEAR.replace('"120 um"', "120").replace("seed", "sed").replace("6.87", '"6"')
    with pytest.raises(mf.InvalidInput) as error:
        read(text)
    assert len(str(error.value).splitlines()) == 3


def test_the_cost_of_many_sites_is_reported_before_the_design(read):
    facts = []
    with mf.progress.listening(lambda step, done: None, facts.append):
        tell_cost(64)
        tell_cost(1_000_000)
    assert len(facts) == 1
    assert re.match(r"1,000,000 sites: about \d+ s and \d\.\d GiB of memory", facts[0])


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"120 um"', '"1e-90 mm"', "limits.max_height = 1e-90 mm is outside the range in which products fit"),
        (
            '"1.5 mm"',
            '"1.5 parsecs"',
            "lattice.pitch = 1.5 parsecs and lattice.radius = 526 um differ by a factor of 9e",
        ),
        ('"20 mm"', '"1e20 m"', r"lattice.block.width = 1e\+23 mm and lattice.radius = 526 um differ"),
        ('"84 um"', '"1e20 m"', r"lattice.height\[0\] = 1e\+23 mm and lattice.radius\[0\] = 526 um differ"),
        ('"84 um"', '"-84 um"', "limits.offset = -84 um must be at least 0 um"),
        ('"6 um"', '"200 um"', "limits.height_step = 200 um must be at most 120 um"),
        (
            'height_step = "6 um"',
            'min_height = "130 um"',
            "min_height = 130 um must be below limits.max_height = 120",
        ),
        ("slope = 6.87", "slope = 1979-05-27", "target.slope = 1979-05-27 must be a number, without quotes"),
        ("slope = 6.87", "slope = true", "target.slope = true must be a number"),
        ("poisson_ratio = 0.5", "poisson_ratio = 0x" + "f" * 5000, "material.poisson_ratio = an int must be"),
        ("poisson_ratio = 0.5", "poisson_ratio = " + "9" * 5000, "not valid TOML"),
        ("poisson_ratio = 0.5", "a" + ".a" * 9000 + " = 1", "nests its values too deeply"),
        ('"independent"', '"in\\nde"', r'model.kind = "in\\nde" is unknown'),
        ('"1.5 mm"', '"1,5 mm"', "write decimals with a point"),
    ],
)
def test_errors_state_what_was_written(read, old, new, words):
    with pytest.raises(mf.InvalidInput, match=words) as error:
        read(LINEAR.replace(old, new, 1))
    assert len(str(error.value).splitlines()) == 1
    assert "Input should" not in str(error.value)


def test_all_values_out_of_range_are_reported(read):
    text = LINEAR.replace('"1.36 MPa"', '"-1 MPa"').replace("6.87", "-6").replace('"84 um"', '"-84 um"')
    with pytest.raises(mf.InvalidInput) as error:
        read(text)
    assert len(str(error.value).splitlines()) == 3


def test_the_end_of_a_truncated_file_is_named(read):
    with pytest.raises(mf.InvalidInput, match="line 2, the end of the file"):
        read("[lattice]\nshape = [8")


@pytest.mark.parametrize("text", ["", "[target]\nkind = 3\n", "target = 3", "[[target]]\n"])
def test_nearly_empty_specifications_are_refused(read, text):
    with pytest.raises(mf.InvalidInput, match=r"lattice is missing; write a section \[lattice\]"):
        read(text)


def test_a_file_that_is_not_utf8_is_refused(read):
    with pytest.raises(mf.InvalidInput, match="line 2 is not UTF-8"):
        read(b"[lattice]\npitch = '5 \xb5m'")


def test_an_unknown_demo_is_refused():
    with pytest.raises(mf.InvalidInput, match="did you mean linear"):
        demo_text("lineal")


def test_sites_are_read(read):
    assert dict(read(LINEAR).pinned) == {}
    sites = '[sites]\nempty = [17, 3]\npinned = [9, 12]\nheights = ["150 um", "0.12 mm"]\n'
    assert read(LINEAR + sites).pinned == {3: None, 17: None, 9: 0.15, 12: 0.12}


def test_empty_sites_are_kept_by_the_design(read):
    result = read(LINEAR + "[sites]\nempty = [3, 17]\n").design()
    assert dict(result.pinned) == {3: None, 17: None}
    assert result.surface.count == 62


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("empty = [3, 64]", r"sites.empty\[1\] = 64 is not a site: the lattice has the sites 0 to 63"),
        ("empty = [3, 3]", r"sites.empty\[1\] = 3 is given twice"),
        ("empty = [-3]", r"sites.empty\[0\] = -3 must be at least 0; write for example empty = \[17\]"),
        ("empty = [0.5]", r"sites.empty\[0\] = 0.5 must be a whole number"),
        (
            'empty = [3]\npinned = [3]\nheights = ["100 um"]',
            r"sites.pinned\[0\] = 3 is given twice; keep one",
        ),
        (
            'pinned = [3, 4]\nheights = ["100 um"]',
            "sites.heights has 1 entries and sites.pinned 2; give one height for each pinned site",
        ),
        (
            'pinned = [3]\nheights = ["300 um"]',
            r"sites.heights\[0\] = 300 um must be at most 204 um, limits.offset \+ limits.max_height",
        ),
        ('pinned = [3]\nheights = ["-1 um"]', r"sites.heights\[0\] = -1 um must be at least 0"),
        ('pinned = [3]\nheights = ["0 um"]', r"sites.heights\[0\] = 0 um must be greater than 0 in a part"),
        ("pinned = [3]\nheights = [0.1]", r"sites.heights\[0\] = 0.1 needs a unit"),
        (f"empty = {list(range(64))}", "sites.empty holds all 64 sites; leave out at least one"),
    ],
)
def test_sites_that_do_not_fit_are_refused(read, keys, words):
    with pytest.raises(mf.InvalidInput, match=words):
        read(f"{LINEAR}[sites]\n{keys}\n")
