"""How likely a made surface meets its target, in words."""

import metafem as mf
from metafem.studies import summary


def test_a_misfit_of_rounding_is_none(template):
    design = mf.design(mf.OperatingPoints([0.0747], [0.642]), template)
    found = summary(mf.studies.combined(design, mf.Tolerances(height_sd=0.003), draws=64))
    assert found.notes[0].text.startswith("misfit 0 % without errors; median of the surfaces")
    assert found.title.startswith("Target met within 10 %: probability")
