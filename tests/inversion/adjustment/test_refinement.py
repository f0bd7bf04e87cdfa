"""Heights that are refined under a model with interaction."""

import pytest

import metafem as mf
from metafem.inversion.assessment import EXACT
from tests.models.scenes import PEDESTAL, said

MODELS = [mf.Interacting(), mf.Interacting(substrate=mf.BondedLayer()), PEDESTAL]


def lattice(max_height, shape):
    block = mf.Block(20, 20, 7.2)
    return mf.Surface.square_lattice(max_height, shape, radius=0.526, material=mf.Material(1.36), block=block)


@pytest.mark.parametrize("model", MODELS, ids=["half-space", "layer", "pedestals"])
@pytest.mark.parametrize("shape", [(2, 2), (2, 3), (3, 3), (4, 4)])
def test_points_that_four_asperities_meet_are_met_on_any_number_of_sites(model, shape):
    """Summits are added on empty sites where the friction must be raised, and only there."""
    target = mf.OperatingPoints([0.02, 0.05], [0.16, 0.33])
    design = mf.design(target, lattice(0.3, shape), model, mf.Limits(0.3))
    assert design.misfit <= EXACT
    assert design.status is mf.DesignStatus.EXACT


def test_heights_that_no_search_improves_are_not_called_refined():
    target = mf.PowerLaw(0.645, (0.02, 0.1))
    design = mf.design(target, lattice(0.12, (4, 4)), MODELS[1], radii=[0.2, 0.8])
    assert "moved" not in said(design)
    assert design.status is mf.DesignStatus.REACHED


def test_no_heights_are_evaluated_twice_in_a_refinement(template, monkeypatch):
    seen, sensitivity = [], mf.Interacting.sensitivity

    def recorded(model, surface, load, height=None):
        seen.append((surface.height if height is None else height).tobytes())
        return sensitivity(model, surface, load, height)

    monkeypatch.setattr(mf.Interacting, "sensitivity", recorded)
    mf.design(mf.PowerLaw(1.2, (0.1, 0.4)), template, mf.Interacting(), mf.Limits(0.27))
    assert len(seen) == len(set(seen)) > 1
