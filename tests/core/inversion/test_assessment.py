"""How a misfit is printed, and the loads of the law of a design."""

import pytest

import metafem as mf
from metafem.inversion.assessment import misfit_text
from metafem.inversion.problem import drafting


@pytest.mark.parametrize(
    ("misfit", "text"),
    [
        (0.0, "below 1e-9"),
        (0.0049, "0.49 %"),
        (0.01, "1 %"),
        (0.01003, "1.003 %"),
        (0.1004, "10.04 %"),
        (0.0999, "10 %"),
        (3.3, "330 %"),
        (float("nan"), "nan %"),
    ],
)
def test_a_misfit_above_a_limit_is_not_printed_as_the_limit(misfit, text):
    assert misfit_text(misfit) == text


def test_the_law_of_a_draft_has_fewer_loads_and_the_same_end():
    template = mf.Surface.square_lattice(0.27, radius=0.526, material=mf.Material(1.36))
    model = mf.Interacting(substrate=mf.BondedLayer(thickness=7.2))
    for target in (mf.PowerLaw(0.9, (0.1, 0.4)), mf.OperatingPoints([0.144, 0.336], [0.84, 1.68])):
        whole = mf.design(target, template, model)
        with drafting():
            draft = mf.design(target, template, model)
        assert (len(whole.law.load), len(draft.law.load)) == (100, 25)
        assert draft.law.load[-1] == whole.law.load[-1]
        assert draft.misfit < 1e-2
        assert draft.law.residual.max() <= 1e-12
