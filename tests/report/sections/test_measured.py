"""The section of the report on the measured law."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, compare
from metafem.report.page import page
from metafem.report.sections.measured import measured_figure, measured_section
from metafem.studies.measurements import measured


@pytest.fixture(scope="module")
def design():
    template = mf.Surface.square_lattice(
        0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
    )
    return mf.design(mf.BilinearLaw((7.15, 12.52), 0.0737), template)


def law_of(design, factor, label):
    load = np.linspace(0.02, 0.25, 14)
    force = factor * mf.friction_law(design.surface, load=load).friction_force
    surface = design.surface
    return MeasuredLaw(
        load, friction_force=force, material=surface.material, friction=surface.friction, label=label
    )


def study_of(design, *factors, **options):
    laws = [
        law_of(design, factor, label) for factor, label in zip(factors, ("static", "sliding"), strict=False)
    ]
    return measured([compare(law, design, **options) for law in laws], design.law.model)


def test_both_laws_are_drawn_with_bars_and_residuals(design):
    study = study_of(design, 1.0, 1.1)
    above, below = measured_figure(design, study).axes
    labels = [text.get_text() for text in above.get_legend().get_texts()]
    assert {"measured: static", "measured: sliding", "crossover, 68 %: static"} <= set(labels)
    assert len(above.containers) == 2
    figure = above.figure
    figure.draw_without_rendering()
    legend = above.get_legend().get_window_extent()
    assert legend.y0 >= above.get_window_extent().y1 - 1.0  # it covers no point
    assert legend.y1 <= figure.bbox.y1
    assert legend.x1 <= figure.bbox.x1
    drawn = [line.get_ydata() for line in below.lines if line.get_marker() == "o"]
    np.testing.assert_allclose(drawn[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(drawn[1], (study.deviation / study.deviation_sd).values[14:])
    assert above.get_xlim()[1] < 0.25 / 1.36 * 1.2  # no wider than the measured loads


def test_the_section_states_the_agreement_and_the_errors_in_it(design):
    assert measured_section(design, {}) is None
    section = measured_section(
        design,
        {"measured": study_of(design, 1.1, parameters={"composite_modulus": 0.04, "area_ratio": 0.01})},
    )
    assert section["differs"]
    assert section["bars"] == ", which include the errors of E* and B"
    assert [row[1].split(",")[0] for row in section["features"]] == ["slope 1", "slope 2", "crossover"]


@pytest.mark.slow  # the command's test reads the section of a page too
def test_the_page_has_the_section(design):
    text = page(design, studies={"measured": study_of(design, 1.1)})
    assert ">Measured law</h2>" in text
    assert "does not agree with the design within its error bars" in text
    assert ">Measured law</h2>" not in page(design)


def test_laws_of_one_label_are_refused(design):
    law = law_of(design, 1.0, "static")
    with pytest.raises(mf.InvalidInput, match="must be different"):
        measured([compare(law, design)] * 2, design.law.model)
    with pytest.raises(mf.InvalidInput, match="must be different"):
        measured([], design.law.model)
