"""Laws of any shape under any model, their bounds, and what cannot be reached."""

import pytest

import metafem as mf


@pytest.mark.slow
def test_a_design_under_resolved_contacts_is_refined_and_drawn():
    """Light loads that the cells do not resolve are those of order 3, and a note says so."""
    template = mf.Surface.square_lattice(0.12, (2, 3), radius=0.526, material=mf.Material(1.36))
    target = mf.OperatingPoints([0.0067, 0.02], [0.073, 0.173])
    result = mf.design(target, template, mf.BoundaryElements(0.013))
    assert result.misfit <= 1e-6
    assert any("gradients were those of the model half-space" in str(note) for note in result.notes)
    assert any("the law is that of the model half-space" in str(note) for note in result.law.notes)
