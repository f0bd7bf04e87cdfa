"""The numbers of the page: those of the design, of its law and of other models."""

import math
import re
from dataclasses import replace
from html import unescape
from importlib import import_module

import numpy as np
import pytest
from jinja2 import UndefinedError

import metafem as mf
from metafem.drawing.inline import Drawn
from metafem.prediction.tolerances import scatter
from metafem.report import all_notes, error_data, error_words, figures, fit_table, model_data, parameter_rows
from metafem.report.figures import law_figure
from metafem.report.html import headings, render
from metafem.report.page import page
from metafem.report.words import PARAMETERS

LATTICE = mf.Surface.square_lattice(
    0.12, (4, 4), radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85),
    block=mf.Block(12.0, 10.0, 3.0),
)  # fmt: skip
POINTS = mf.OperatingPoints([0.02, 0.05], [0.2, 0.45])


FIGURES = ("law", "coefficient", "onset", "height", "interaction", "contact")


def words_of(design, **options):
    """Return the page without its pictures, which take most of its time."""
    module = import_module("metafem.report.page")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "drawn", lambda figure, title: Drawn(title, "", ""))
        for name in FIGURES:
            patch.setattr(figures, f"{name}_figure", lambda *_: None)
        return page(design, **options)


def rows_of(text):
    """Return the rows of all tables of a page as texts."""
    rows = re.findall(r"<tr>(.*?)</tr>", text, re.DOTALL)
    cells = (re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row, re.DOTALL) for row in rows)
    return [[unescape(re.sub("<[^>]+>", "", cell)) for cell in row] for row in cells]


def rms(values):
    return math.sqrt(float(np.mean(np.square(values))))


def test_the_page_states_the_numbers_of_the_design():
    limits = mf.Limits(0.12, offset=0.084, height_step=0.006, height_sd=0.0009, pinned={3: None, 5: 0.1})
    design = mf.design(mf.LinearLaw(6.87), LATTICE, limits=limits, rng=1)
    text, law, surface = words_of(design), design.law, design.surface
    rows = rows_of(text)
    base = 4.0 / 3.0 * 1.36 * math.sqrt(0.526) * float((surface.height**1.5).sum())  # Hertz's load at d = h
    for row in (
        ["composite modulus E*", "1.36", "MPa"], ["Poisson's ratio ν", "0.5", ""],
        ["shear strength σ", "0.358", "MPa"],
        ["area ratio B", "0.85", ""], ["summit radius R", "526", "µm"], ["sites for asperities", "16", ""],
        ["block", "12 × 10 × 3", "mm"], ["largest height h_m", "120", "µm"], ["offset h_0", "84", "µm"],
        ["height step", "6", "µm"], ["height error", "0.9", "µm"], ["given height of site 6", "100", "µm"],
        ["sites that stay empty by the specification", "4", ""],
        ["load at which the glass touches the base", f"{base:.4g}", "N"],
    ):  # fmt: skip
        assert row in rows
    assert f"reaches the base plane at {base:.4g} N; the loads shown end at {law.load[-1]:.4g} N" in text
    heights = 1e3 * surface.height
    misfit, error, scattered = re.findall(r"<b>(.*?)</b>", text)
    assert misfit == f"{100.0 * design.misfit:.2g} %"
    assert error == f"{100.0 * law.model_error:.2g} %"
    mean, sd = scatter(surface, law.model, design.target_law.load, 0.0009)
    assert scattered == f"{100.0 * rms(np.hypot(mean - 1.0, sd)):.2g} %"
    assert f"{heights.min():.1f} – {heights.max():.1f} µm on {surface.count} of 16 sites" in text
    (branch, fit), *_ = design.fits
    columns, (row, *_) = fit_table(design)
    assert all(list(pair) in rows for pair in zip(columns, row, strict=True))
    half = 0.5 * (fit.slope_interval[1] - fit.slope_interval[0])
    assert row == (
        "{:.4g} – {:.4g}".format(*fit.load_range), "6.87", f"{fit.slope:.4g} ± {half:.1g}",
        f"{100.0 * (fit.slope / 6.87 - 1.0):+.2f} %", f"{fit.intercept:.4f}", f"{branch.intercept:.4f}",
        f"{fit.slope * 0.358 * 0.85 / 1.36:.4g}", f"{fit.intercept * 0.358 * 0.85:.4f}",
    )  # fmt: skip
    for place, model in ((2, mf.Interacting()), (3, mf.Interacting(substrate=mf.BondedLayer()))):
        other = mf.friction_law(surface, model, load=law.load)
        change, sinking = other.area / law.area - 1.0, 1e3 * (law.separation - other.separation)[-1]
        found = {row[0]: row[place] for row in rows if len(row) == 5}
        assert found["rms [%]"] == f"{100.0 * rms(change):.2f}"
        assert found["largest [%]"] == f"{100.0 * change[np.abs(change).argmax()]:+.2f}"
        assert found["glass lower by [µm]"] == f"{sinking:+.2f}"
    assert "the true block is left out" in text
    assert "Model: independent; estimated error of A0(P)" in text
    assert "<code>Independent()</code>" in text
    assert f"residual of the equilibria: {law.residual.max():.1e}" in unescape(text)
    onset = mf.onset(surface, load=float(law.load[-1]))
    for number in (onset.displacement[-1] * 1e3, onset.friction_force[-1], onset.stiffness):
        assert f"{number:.3g}" in text[text.index("onset of sliding</h2>") :]
    assert design.verdict[:40] in text


def test_the_page_is_self_contained():
    design = mf.design(POINTS, LATTICE.replaced(block=None), limits=mf.Limits(0.16))
    text = page(design)
    links = re.findall(r"""(?:src|href)="([^"]*)"|url\(([^)]*)\)""", text)
    assert {(first or second)[0] for first, second in links} <= {"#", "d"}  # elements, and data
    assert text.count("<svg") == 6
    names = re.findall(' id="([^"]*)"', text)
    assert len(names) == len(set(names))


def test_the_misfit_is_that_of_the_drawn_difference():
    for target, meaning in (
        (POINTS, "largest difference from the target"),
        (mf.LinearLaw(6.87), "rms difference from the law of the height density"),
        (mf.LinearLaw(9.0, (0.01, 0.05)), "largest difference from the target"),
        (mf.PowerLaw(1.2, (0.02, 0.05)), "rms difference from the target"),
    ):
        design = mf.design(target, LATTICE, limits=mf.Limits(0.16))
        law = design.target_law
        difference = law.difference(mf.friction_law(design.surface, load=1.36 * law.load).area)
        drawn = law_figure(design).axes[1].lines[-1]
        np.testing.assert_array_equal(drawn.get_xdata(), law.load)
        np.testing.assert_allclose(drawn.get_ydata(), 100.0 * difference, rtol=1e-9, atol=1e-9)
        misfit = np.abs(difference).max() if law.pointwise else rms(difference)
        assert design.misfit == pytest.approx(misfit, rel=1e-9, abs=1e-12)
        assert f"misfit: {meaning}" in words_of(design)


# Printed unit of each parameter, and its factor.
UNITS = {
    ("µm", 1e3): "scale crossover_height levels adjustment_heights span used_radii step_levels",
    ("mm²", 1.0): "intercept foot_load intercepts load_range",
    ("mm^(2-2β)", 1.0): "prefactor",
    ("%", 100.0): "tilt_before tilt_after step_loss",
    ("", 1.0): "weight counts radius_counts tool_counts used_exponents exponent_counts step_counts",
}


def test_parameters_have_their_units_and_no_false_digits():
    design = mf.design(POINTS, LATTICE, limits=mf.Limits(0.16))
    units = {name: pair for pair, names in UNITS.items() for name in names.split()}
    assert units.keys() == PARAMETERS.keys()
    rows = parameter_rows(replace(design, parameters=dict.fromkeys(units, 0.123456789)))
    for (_, value, unit), (printed, factor) in zip(rows, units.values(), strict=True):
        assert (unit, value) == (printed, f"{factor * 0.123456789:.{3 if unit == '%' else 6}g}")
    values = {"intercept": 4.12643e-112, "levels": np.array([0.1, 1e-15]), "counts": np.arange(30)}
    rows = {unit: value for _, value, unit in parameter_rows(replace(design, parameters=values))}
    many = ", ".join(map(str, range(24))) + ", and 6 more in design.json"
    assert rows == {"mm²": "0", "µm": "100, 0", "": many}


def test_other_inputs_are_stated():
    design = replace(mf.design(POINTS, LATTICE, limits=mf.Limits(0.16), rng=1), notes=())
    radius = np.linspace(0.3, 0.8, design.surface.count)
    surface = design.surface.replaced(radius=radius, height=np.linspace(0.1, 0.16, len(radius)))
    law = mf.friction_law(surface, load=design.law.load)
    other = replace(design, surface=surface, law=law, tools=mf.RadiusRange(0.2, 0.8, 0.01))
    given = replace(design, tools=(mf.Tool(0.3), mf.Tool(0.5)))
    tools_row = "tools to choose from, lengths in mm"
    for changed, rows in (
        (other,
         [["summit radius R", "300 – 800", "µm"],
          [tools_row, "RadiusRange(low=0.2, high=0.8, step=0.01)", ""],
          ]),
        (given, [[tools_row, "(Tool(radius=0.3, cap=Sphere()), Tool(radius=0.5, cap=Sphere()))", ""]]),
    ):  # fmt: skip
        found = rows_of(words_of(changed))
        assert all(row in found for row in rows)


def test_slopes_of_friction_coefficients_are_stated_in_newtons():
    target = mf.LinearLaw.from_friction_coefficient(2.0, LATTICE.material, LATTICE.friction, (0.02, 0.07))
    design = mf.design(target, LATTICE, limits=mf.Limits(0.16))
    columns, ((load, wanted, fitted, _, intercept, _),) = fit_table(design)
    assert columns[:2] == ("loads [N]", "target friction coefficient")
    (_, fit), per_slope = design.fits[0], 0.358 * 0.85 / 1.36
    assert (load, wanted) == ("{:.4g} – {:.4g}".format(*(1.36 * end for end in fit.load_range)), "2")
    assert fitted.startswith(f"{per_slope * fit.slope:.4g} ± ")
    assert intercept == f"{0.358 * 0.85 * fit.intercept:.4f}"


def test_warnings_come_first_and_make_the_page_red():
    low = mf.design(mf.LinearLaw(6.87), LATTICE, limits=mf.Limits(0.12, height_sd=0.01))
    text = words_of(low, hardness=0.5)
    assert 'class="before warned"' in text
    assert "plasticity index" in text
    assert "No warnings" not in text
    levels = [note.warns for note in all_notes(low, 0.5)]
    assert levels == sorted(levels, reverse=True)
    with pytest.warns(mf.errors.MetafemWarning):
        psi = mf.plasticity_index(low.surface, 0.5)
    (index,) = [note for note in all_notes(low, 0.5) if note.quantity == "plasticity index"]
    assert (index.value, index.bound) == (psi, 0.6)
    assert all_notes(low, 1e3) == tuple(sorted(low.notes, key=lambda note: not note.warns))
    calm = replace(mf.design(POINTS, LATTICE, limits=mf.Limits(0.16, offset=0.2)), notes=())
    text = words_of(calm)
    assert "No warnings" in text
    assert 'class="before warned"' not in text


def test_models_and_their_errors_are_data():
    jkr = mf.Independent(mf.JKR(1.604e-5, mf.Elastic()))
    code = "Independent(contact=JKR(adhesion_energy=1.604e-05, cap=Elastic()))"
    assert model_data(jkr) == {"name": jkr.name, "python": code}
    error = mf.equilibrium(LATTICE, mf.Interacting(1), load=0.02).model_error
    assert error_data(error) == {"value": float(error), "source": "order 3 on the half-space"}
    assert error_words(error).startswith(f"estimated error of A0(P): {100.0 * error:.2g}"[:30])
    unknown = mf.equilibrium(LATTICE, mf.Interacting(), load=0.02).model_error
    assert not math.isnan(unknown) or error_data(unknown)["value"] is None


PAGE = """{% extends "base.html" %}{% from "macros.html" import table %}
{% block title %}A & B{% endblock %}
{% block navigation %}{{ bar|safe }}{% endblock %}
{% block main %}<h2 id="one">First <b>part</b></h2>{{ table(["<x>"], [["&"]]) }}{% endblock %}
"""


def test_templates_escape_texts_and_list_their_headings(tmp_path):
    (tmp_path / "own.html").write_text(PAGE, "utf-8")
    text = render("own.html", tmp_path, bar="")
    assert text.startswith("<!doctype html>")
    assert headings('<h2 id="a">A <i>b</i></h2><h2>without</h2>') == [("a", "A b")]
    assert text.count('<a href="#one">First part</a>') == 2
    assert "<th>&lt;x&gt;</th>" in text
    assert "<td>&amp;</td>" in text
    with pytest.raises(UndefinedError, match="'bar' is undefined"):
        render("own.html", tmp_path)
