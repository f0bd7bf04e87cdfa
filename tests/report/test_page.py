"""The page: self-contained, the same to the byte, and saying what it should."""

import re
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

import metafem as mf
from metafem.drawing import TARGET
from metafem.drawing.inline import Drawn
from metafem.files import DEMOS
from metafem.report import all_notes, parameter_rows
from metafem.report.figures import force_figure, law_figure
from metafem.report.page import page

# The pages of all demos; those of the others than the linear one run with the slow tests.
KINDS = [pytest.param(kind, marks=[pytest.mark.slow] * (kind != "linear")) for kind in DEMOS]


def words_of(design, **options):
    """Return the page without its pictures, which take most of its time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            import_module("metafem.report.page"), "drawn", lambda figure, title: Drawn(title, "", "", "")
        )
        return page(design, **options)


@pytest.fixture
def paper(demo_results):
    """A function that returns one of the paper's designs and the page that the command wrote for it."""

    def call(name):
        folder, _ = demo_results(name)
        return mf.load(folder / name), (folder / name / "report.html").read_text("utf-8")

    return call


@pytest.mark.parametrize(
    ("tools", "words"),
    [
        (
            [mf.Tool(0.3), mf.Tool(0.5, mf.Power(4))],
            ["Sphere() of R = 300 µm", "numbers of asperities of each"],
        ),
        (mf.PowerRange(1.2, 6.0), ["exponents of power caps to choose from", "1.2 – 6 in steps of 0.1"]),
    ],
)
def test_page_states_the_tools_to_choose_from(template, tools, words):
    limits = mf.Limits(0.27)
    text = words_of(mf.design(mf.PowerLaw(0.6, (0.1, 0.2)), template, limits=limits, tools=tools))
    for each in words:
        assert each in text


@pytest.mark.parametrize("kind", KINDS)
def test_page_is_self_contained_and_reproducible(paper, kind):
    design, text = paper(kind)
    assert text == page(design)
    assert not re.findall("use the model (layer|half-space|resolved)|base plane would touch", text)
    links = re.findall(r"""(?:src|href)="([^"]*)"|url\(([^)]*)\)""", text)
    assert {(first or second)[0] for first, second in links} <= {
        "#",
        "d",
    }  # elements of the page, and data: images
    assert text.count("<svg") == 8
    assert "<td>layer</td>" in text
    assert "Model: independent, in Python Independent()" in text
    assert "radius [µm]" not in text  # a column for radii that differ
    assert design.status.value.split(":")[0] in text


def test_page_states_tools_and_steps(template):
    limits, radii = mf.Limits(0.27, height_step=0.002), [0.4, 0.526]
    line = mf.LinearLaw(9.0, (0.05, 0.2))
    text = words_of(mf.design(line, template, limits=limits, tools=radii, common_radius=True))
    for words in ("radii tried", "Friction proportional to load: slope 9 from 0.05 to 0.2 mm²"):
        assert words in text
    assert "heights are on steps of 2 um" in text
    assert "numbers of asperities on these levels" in text


@pytest.mark.parametrize(
    ("radius", "stated"),
    [
        (np.random.default_rng(0).choice([0.3, 0.526, 0.8], 64), "300, 526, 800"),
        pytest.param(np.linspace(0.3, 0.8, 64), "300 – 800", marks=pytest.mark.slow),
    ],
    ids=["tools", "any"],
)
def test_page_states_radii_that_differ(template, radius, stated):
    design = mf.design(mf.LinearLaw(6.87), template, limits=mf.Limits(0.12, offset=0.084))
    surface = design.surface.replaced(radius=radius)
    text = page(replace(design, surface=surface, law=mf.friction_law(surface, load=design.law.load)))
    assert f'summit radius R</td><td class="number">{stated}</td>' in text
    assert text.count("<td>300</td>") == (radius == 0.3).sum()
    assert len(re.findall(r"(?<!/)R = ", text)) == 3  # what the markers' sizes mean


def test_page_warns_of_plastic_contacts_and_low_summits(template):
    design = mf.design(mf.LinearLaw(6.87), template, limits=mf.Limits(0.12, height_sd=0.0009))
    text = words_of(design, hardness=0.5)
    assert "plasticity index" in text
    assert "raise the offset" in text


def test_page_states_which_law_a_hardness_takes(template):
    target = mf.SampledLaw([0.05, 0.1, 0.2], [0.6, 1.1, 1.9])
    design = mf.design_for_hardness(target, template, 0.3, limits=mf.Limits(0.27))
    text = words_of(design, hardness=0.3)
    assert "this design is for the law KogutEtsion(hardness=0.3) of plastic contacts" in text
    assert "E*/H below which these contacts stay elastic" in text
    assert "was not evaluated" not in text


def test_page_warns_where_the_plane_would_reach_the_base(template):
    design = mf.design(
        mf.OperatingPoints([0.144, 0.336], [0.84, 1.68]), template, limits=mf.Limits(0.27 - 0.1284)
    )
    assert "base plane would touch" in words_of(design)


def test_page_leaves_out_a_true_block_that_is_not_kept(template, tmp_path, monkeypatch):
    monkeypatch.setattr("metafem.fe.block3d.cache.cache_folder", lambda: tmp_path)
    text = words_of(mf.design(mf.LinearLaw(6.87), template))
    assert "the true block is left out" in text
    assert "metafem study fidelity" in text


@pytest.mark.slow
def test_page_with_the_finite_element_checks(full_report):
    text = full_report.read_text("utf-8")
    # three pictures of the checks, and one of each study
    assert text.count("<svg") == 8 + 3 + 3
    assert re.search(r"(\d+) checks, \1 passed", text)


@pytest.mark.parametrize(
    ("target", "words"),
    [
        (mf.OperatingPoints([0.144, 0.336], [0.84, 1.68]), "largest difference from the target"),
        (mf.LinearLaw(6.87), "rms difference from the law of the height density"),
        (mf.BilinearLaw((7.15, 12.52), 0.038), "difference of a fitted slope from the target&#39;s"),
        (mf.LinearLaw(9.0, (0.05, 0.2)), "largest difference from the target"),
        (mf.PowerLaw(1.2, (0.1, 0.2)), "rms difference from the target"),
    ],
)
def test_page_defines_the_misfit(template, target, words):
    """And its value is that of the drawn difference."""
    design = mf.design(target, template, limits=mf.Limits(0.27))
    text = words_of(design)
    assert f"misfit: {words}" in text
    assert "largest deviation" not in text
    if "slope" in words:
        return
    load, law = template.material.composite_modulus * design.target_law.load, design.target_law
    difference = law.difference(mf.friction_law(design.surface, load=load).area)
    deviation = np.abs(difference).max() if law.pointwise else np.sqrt((difference**2).mean())
    assert design.misfit == pytest.approx(deviation, rel=1e-9, abs=1e-12)
    drawn = law_figure(design).axes[1].lines[-1].get_ydata()
    np.testing.assert_allclose(drawn, 100.0 * difference, rtol=1e-9, atol=1e-9)


def test_the_bar_is_red_for_warnings_alone(template):
    small = template.replaced(height=np.full(64, 0.05))
    stepped = mf.design(mf.PowerLaw(1.2, (0.01, 0.05)), small, limits=mf.Limits(0.12, height_step=0.001))
    notes = all_notes(stepped)
    assert notes
    assert not any(note.warns for note in notes)
    assert '<section class="informed">' in words_of(stepped)
    fine = mf.design(mf.LinearLaw(6.87), template, limits=mf.Limits(0.12, offset=0.084, height_sd=0.01))
    assert '<section class="warned">' in words_of(fine)


def test_page_mentions_other_seeds_for_random_layouts_alone(paper):
    design, text = paper("linear")
    placed = replace(design, layout=mf.Layout())
    assert ("another seed" in text, "another seed" in words_of(placed)) == (True, False)


@pytest.mark.slow
def test_a_page_of_thousands_of_summits_is_small():
    template = mf.Surface.square_lattice(0.12, (40, 40), radius=0.526, material=mf.Material(1.36))
    text = page(mf.design(mf.LinearLaw(6.87), template))
    assert len(text) < 1.5e6  # the 2.8 MB of marks and rows grew with the number of summits
    assert "The first 200 of 1600 summits; heights.csv lists all of them" in text
    assert "part of the surface around the tallest summit" in text


def test_forces_are_shown_where_there_is_a_friction(template, paper):
    bare, rubbed = page(mf.design(mf.LinearLaw(6.87), template.replaced(friction=None))), paper("linear")[1]
    for words in ("friction force  F [N]", "friction coefficient  μ = F/P"):
        assert (words in bare, words in rubbed) == (False, True)


@pytest.mark.slow
def test_page_states_friction_coefficients_of_such_a_target(template):
    target = mf.LinearLaw.from_friction_coefficient(1.4, template.material, template.friction, (0.068, 0.272))
    text = page(mf.design(target, template, limits=mf.Limits(0.27)))
    assert "<h1>Friction proportional to load: friction coefficient 1.4 from 0.068 to 0.272 N</h1>" in text
    assert "<th>target friction coefficient</th>" in text
    assert "slope 6." not in text


def crowded(template, **changes):
    """The linear demo on another block or lattice."""
    return mf.design(mf.LinearLaw(6.87), template.replaced(**changes), limits=mf.Limits(0.12, offset=0.084))


@pytest.mark.parametrize("height_sd", [None, 0.0001])
def test_height_errors_are_mentioned_where_they_were_stated(template, height_sd):
    limits = mf.Limits(0.12, offset=0.5, height_sd=height_sd)
    design = mf.design(mf.OperatingPoints([0.01], [0.1]), template, limits=limits)
    text = words_of(replace(design, notes=()))
    assert "No warnings" in text
    assert ("stated height errors" in text) == (height_sd is not None)


@pytest.mark.parametrize("narrow", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_page_warns_of_what_interaction_changes(template, narrow):
    thin = {"block": mf.Block(20.0, 20.0, 0.2)}
    design = crowded(template, **({"position": 0.2 * template.position} if narrow else thin))
    text = words_of(design)
    assert '<section class="warned">' in text
    assert "No warnings" not in text
    assert "the elastic interaction of the asperities, which this model leaves out, changes A0" in text
    assert any("changes A0" in note.text for note in design.notes if note.warns)


def test_a_comparison_that_has_no_solution_is_left_out(template):
    design = crowded(template, position=0.2 / 1.5 * template.position, block=None)
    text = words_of(design)
    assert "the half-space is left out: order 3 has no solution up to" in text
    assert "order 3 has no solution at" in text


def test_parameters_have_no_false_digits(template):
    result = mf.design(mf.PowerLaw(1.1, (0.05, 0.2)), template)
    values = {"step_loss": -0.148688123, "intercept": 4.12643e-112, "levels": np.array([0.1, 1e-15])}
    rows = {unit: value for _, value, unit in parameter_rows(replace(result, parameters=values))}
    assert rows == {"%": "-14.9", "mm²": "0", "µm": "100, 0"}


def test_a_target_over_many_loads_is_a_line(template):
    result = mf.design(mf.BilinearLaw((6.0, 9.0), 0.08, (0.05, 0.2)), template, limits=mf.Limits(0.27))
    figures = law_figure(result), force_figure(result, template.friction)
    for figure in figures:
        drawn = [line for line in figure.axes[0].lines if line.get_color() == TARGET]
        assert len(drawn) == 2
        assert all(line.get_marker() == "None" and line.get_linestyle() == "--" for line in drawn)
