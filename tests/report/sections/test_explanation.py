"""The report's section on what explains a measured law."""

import numpy as np

import metafem as mf
from metafem.calibration import Priors, explain
from metafem.report.sections.explanation import errors_figure, explanation_section, heights_figure
from metafem.studies.measurements import explained
from tests.calibration.diagnosis.scenes import NOTHING, design, measured

PART = design((3, 3))
LAW = measured(PART.tilted(0.001, 0.0), rng=np.random.default_rng(0))


def test_the_section_has_sentences_a_table_and_two_figures():
    study = explained(explain(LAW, PART, model=mf.Independent()))
    section = explanation_section({"explained": study})
    assert section is not None
    assert any("tilt (" in sentence for sentence in section["answers"])
    assert len(section["figures"]) == 2
    assert [row[0] for row in section["rows"]].count("tilt along x") == 1
    (ax,) = errors_figure(study).axes
    assert ax.get_yticklabels()[0].get_text() == "tilt along x"
    assert heights_figure(study).axes[0].get_ylabel() == "error of its height [µm]"


def test_there_is_no_section_without_an_explanation_and_no_figure_without_errors():
    assert explanation_section({}) is None
    alone = explained(explain(LAW, PART, NOTHING, model=mf.Independent()))
    section = explanation_section({"explained": alone})
    assert section is not None
    assert section["figures"] == []
    heights = Priors(0.0, 0.0, 0.0, 0.0, radius_sd=0.0)
    only = explained(explain(LAW, PART, heights, model=mf.Independent()))
    assert len(explanation_section({"explained": only})["figures"]) == 1
