"""The figures of the page show the numbers of the design, its law, its studies and its checks."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import EllipseCollection

import metafem as mf
from metafem import report
from metafem.calibration import MeasuredLaw, compare, explain
from metafem.drawing import TARGET
from metafem.report import studies
from metafem.report.figures import (
    coefficient_figure,
    contact_figure,
    height_figure,
    interaction_figure,
    law_figure,
    onset_figure,
)
from metafem.report.studies import QUESTIONS, measured_figure, measured_section, study_sections
from metafem.studies.measured import explained, measured
from metafem.studies.models import compared
from metafem.studies.summary import summary
from tests.core.report.test_page import LATTICE, POINTS

MATERIAL = LATTICE.material


@pytest.fixture(scope="module")
def design():
    return mf.design(POINTS, LATTICE, limits=mf.Limits(0.16))


def of_surface(design, surface, load=0.5):
    """Return a design whose surface is this one, its law drawn up to a load [N]."""
    law = mf.friction_law(surface, load=[load])
    return replace(design, surface=surface, template=surface, sites=np.arange(surface.count), law=law)


def test_laws_are_drawn_with_their_target_and_forces(design):
    law, strength = design.law, 0.358 * 0.85
    above, below = law_figure(design).axes
    np.testing.assert_array_equal(above.lines[0].get_ydata()[1:], law.area)
    top, right = above.child_axes
    below.figure.draw_without_rendering()
    assert top.get_xlim()[1] / above.get_xlim()[1] == pytest.approx(1.36)
    assert right.get_ylim()[1] / above.get_ylim()[1] == pytest.approx(strength)
    (ax,) = coefficient_figure(design, design.surface.friction).axes
    np.testing.assert_allclose(ax.lines[0].get_ydata(), strength * law.area / law.load, rtol=1e-12)
    load, force = np.array([0.0272, 0.068]), strength * POINTS.rescaled_friction
    np.testing.assert_allclose(ax.lines[1].get_data(), [load, force / load])
    line = mf.design(mf.PowerLaw(0.9, (0.02, 0.05)), LATTICE, limits=mf.Limits(0.16))
    above, _ = law_figure(line).axes
    for ax in (above, *coefficient_figure(line, LATTICE.friction).axes):
        (wanted,) = [each for each in ax.lines if each.get_color() == TARGET]
        assert (wanted.get_marker(), wanted.get_linestyle()) == ("None", "--")


def test_interaction_is_drawn(design):
    models = compared(design, wait=False)
    assert models.model.values.tolist() == ["independent", "half-space", "layer", "layer with pedestals"]
    assert "true block is left out" in models.attrs["notes"]
    _, first, *_ = interaction_figure(models).axes[0].lines
    other = mf.friction_law(design.surface, mf.Interacting(), load=design.law.load)
    np.testing.assert_allclose(first.get_ydata(), 100.0 * (other.area / design.law.area - 1.0), atol=1e-9)
    np.testing.assert_allclose(first.get_xdata(), design.law.rescaled_load)
    own = mf.friction_law(design.surface, mf.Interacting(1), load=design.law.load)
    others = compared(replace(design, law=own), wait=False)
    assert others.model.values[-1] == "half-space, order 1"


def test_heights_and_contacts_are_shown(design):
    ax = height_figure(design).axes[0]
    assert ax.get_title() == f"{len(ax.collections[0].get_offsets())} sites stay empty (rings)"
    surface = mf.Surface.square_lattice([0.1, 0.1, 0.2, 0.2], (2, 2), radius=0.526, material=MATERIAL)
    first, _, last = contact_figure(of_surface(design, surface)).axes
    for ax, count, load in ((first, 2, 0.05), (last, 4, 0.5)):
        hollow, filled = (part for part in ax.collections if isinstance(part, EllipseCollection))
        assert (len(hollow.get_offsets()), len(filled.get_offsets())) == (4 - count, count)
        state = mf.equilibrium(surface, load=load)
        assert ax.get_title() == f"P = {load:g} N\n{count} of 4 in contact, {state.area:.3g} mm²"
        diameter = 2.0 * np.sqrt(state.asperity_area[state.asperity_area > 0.0] / np.pi)
        np.testing.assert_allclose(filled.get_widths(), np.maximum(diameter, 0.1 * 0.75), rtol=1e-9)


def test_studies_are_drawn_and_answered(design):
    made = mf.studies.manufacturing(design.surface, (0.003, 0.001), draws=5)
    tilted = mf.studies.misalignment(design.surface, [0.0005, 0.001], assignments=2)
    inputs = mf.studies.uncertainty(design.surface, {"composite_modulus": 0.04, "radius": 0.002})
    ax = studies.manufacturing_figure({"a": made}).axes[0]
    line, _, (bars,) = ax.containers[0].lines
    one = made.sortby("height_sd")
    np.testing.assert_allclose(line.get_xdata(), [1.0, 3.0])
    np.testing.assert_allclose(line.get_ydata(), one["slope_mean"] / float(one["nominal_slope"]))
    span = np.ptp(np.array(bars.get_segments())[:, :, 1], axis=1)
    np.testing.assert_allclose(span, 2.0 * one["slope_sd"] / float(one["nominal_slope"]))
    first, *others = studies.misalignment_figure({"a": tilted}).axes[0].lines
    np.testing.assert_allclose(first.get_xdata(), np.degrees([0.0, 0.0005, 0.001]))
    scatter = 100.0 * tilted["slope_sd"].values / float(tilted["nominal_slope"])
    np.testing.assert_allclose([line.get_ydata()[1:] for line in (first, *others)], scatter)
    (right,) = studies.uncertainty_figure(inputs).axes
    weight = inputs["friction_force_sd"].values ** 2
    for bars, index in zip(right.containers, ("total", "first_order"), strict=True):
        mean = inputs[f"friction_force_{index}"].values @ weight / weight.sum()
        np.testing.assert_allclose([bar.get_width() for bar in bars], 100.0 * mean)
    section = study_sections(design, {"manufacturing": made, "misalignment": tilted, "uncertainty": inputs})
    low, high = made.attrs["load_range"]
    for (name, picture, found), asked in zip(section["answers"], QUESTIONS, strict=True):
        assert (name, picture.title, found.answer[-1]) == (asked, QUESTIONS[asked][0], ".")
        assert {len(row) for row in found.rows} == {len(found.columns)}
        assert f"P/E* = {low:.4g} to {high:.4g} mm^2" in str(found.notes[0])
    assert section["missing"] == []


def test_a_measured_law_is_drawn_and_compared(design):
    bilinear = mf.design(mf.BilinearLaw((7.15, 12.52), 0.02), LATTICE, limits=mf.Limits(0.16))
    load, pair = np.linspace(0.01, 0.06, 14), {"material": MATERIAL, "friction": LATTICE.friction}
    force = 1.1 * mf.friction_law(bilinear.surface, load=load).friction_force
    law = MeasuredLaw(load, friction_force=force, **pair)
    errors = {"parameters": ["composite_modulus", "area_ratio"], "covariance": np.diag([1.6e-3, 1e-4])}
    study = measured(compare(law, bilinear, **errors), bilinear.law.model)
    above, below = measured_figure(bilinear, study).axes
    (drawn,) = (line.get_ydata() for line in below.lines if line.get_marker() == "o")
    np.testing.assert_allclose(drawn, (study.deviation / study.deviation_sd).values)
    line, _, (across, up) = above.containers[0].lines
    np.testing.assert_array_equal(line.get_ydata(), study.rescaled_friction)
    spans = (np.ptp(np.array(bar.get_segments())[:, :, k], axis=1) for k, bar in ((0, across), (1, up)))
    for span, name in zip(spans, ("rescaled_load_sd", "rescaled_friction_sd"), strict=True):
        np.testing.assert_allclose(span, 2.0 * study[name])
    assert above.get_xlim()[1] == pytest.approx(1.08 * (study.rescaled_load + study.rescaled_load_sd).max())
    section = measured_section(bilinear, study)
    assert (section["differs"], section["included"]) == (not int(study.fits), "E* and B")


def test_what_explains_a_law_is_a_table():
    lattice = LATTICE.replaced(height=np.random.default_rng(0).uniform(0.05, 0.12, 16))
    load = np.linspace(0.02, 0.3, 12)
    tilted = mf.friction_law(lattice.tilted(0.002, 0.0), load=load)
    law = MeasuredLaw(load, area=tilted.area, material=MATERIAL)
    found = summary(explained(explain(law, lattice)))
    assert [row[0] for row in found.rows] == ["tilt along x", "tilt along y", "height scale", "E*"]
    assert "with these errors agrees with the 12 measured values" in found.answer


def test_the_onset_of_sliding_is_stated(design):
    onset = mf.onset(design.surface, load=0.02)
    words = report.words.onset_words(onset)
    ends = 1e3 * onset.displacement[0], 1e3 * onset.displacement[-1]
    for number in (0.02, *ends, onset.friction_force[-1], onset.stiffness):
        assert f"{number:.3g}" in words
    (ax,) = onset_figure(onset).axes
    np.testing.assert_allclose(ax.lines[1].get_xdata(), 1e3 * onset.displacement)
