"""Heights exchanged between sites make a law insensitive to a tilt."""

import numpy as np
import pytest

import metafem as mf

LATTICE = mf.Surface.square_lattice(0.12, (5, 5), radius=0.526, material=mf.Material(1.36))
POWER, TILT = mf.PowerLaw(0.9, (0.05, 0.1)), 0.001


def change(design, tilt=TILT):
    """Root mean square of the change of A0 by tilts in twelve directions, over the loads of the target."""
    model, load = design.law.model, design.target_law.load
    level, found = model.curve(design.surface, load).area, []
    for angle in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False):
        tilted = design.surface.tilted(*(np.arctan(np.tan(tilt) * np.array([np.cos(angle), np.sin(angle)]))))
        found.append(model.curve(tilted, load).area / level - 1.0)
    return float(np.sqrt(np.square(found).mean()))


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(1)], ids=repr)
def test_the_effect_of_a_tilt_is_reduced_and_the_target_still_met(model):
    design = mf.design(POWER, LATTICE, model)
    found = mf.arrange(design, TILT, rng=1)
    assert found.misfit <= 0.01
    assert change(found) <= 0.4 * change(design)
    assert found.parameters["tilt_before"] == pytest.approx(change(design), rel=0.1)
    if not model.couples:
        assert sorted(found.surface.height) == sorted(design.surface.height)
        # the exchanges were chosen by the changes at ten of the loads
        assert found.parameters["tilt_after"] == pytest.approx(change(found), rel=0.15)
        assert found.misfit == pytest.approx(design.misfit, rel=1e-9)


def test_prescribed_heights_and_empty_sites_stay():
    limits = mf.Limits(0.12, offset=0.05, pinned={7: 0.15, 3: None})
    found = mf.arrange(mf.design(POWER, LATTICE, limits=limits), TILT)
    assert found.surface.height[found.sites == 7] == 0.15
    assert 3 not in found.sites
    assert found.parameters["tilt_after"] <= found.parameters["tilt_before"]


def test_caps_of_several_tools_move_with_their_heights():
    tools = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(4))]
    design = mf.design(mf.PowerLaw(0.6, (0.01, 0.03)), LATTICE, limits=mf.Limits(0.25), tools=tools)
    found = mf.arrange(design, TILT)
    pairs = [sorted(zip(each.surface.height, each.surface.radius, strict=True)) for each in (design, found)]
    assert pairs[0] == pairs[1]
    assert found.misfit == pytest.approx(design.misfit, rel=1e-9)
