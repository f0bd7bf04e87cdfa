"""Targets of stiffness, tangential stiffness and conductance against laws of known surfaces."""

import numpy as np
from numpy.testing import assert_allclose

import metafem as mf

LOADS = np.linspace(0.02, 0.3, 12)


def template(ratio=0.5, **more):
    return mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36, ratio), **more)


def known(seed=0, **more):
    rng = np.random.default_rng(seed)
    return template(**more).replaced(height=0.12 * rng.beta(2.0, 2.0, 64))


def predicted(surface, of, model=None):
    """Return the rescaled quantity [mm] by the predictions, which do not know the inversion."""
    modulus = surface.material.composite_modulus
    newtons = modulus * LOADS
    if of == "stiffness":
        return mf.friction_law(surface, model, load=newtons).rescaled_stiffness
    if of == "conductance":
        return mf.conductance(surface, model, load=newtons, resistivity=1.0).rescaled_conductance
    return mf.tangential_stiffness(surface, model, load=newtons) / modulus


def test_other_kinds_of_targets_are_of_quantities_too():
    points = mf.OperatingPoints(
        LOADS[[1, 5, 11]], predicted(known(), "stiffness")[[1, 5, 11]], of="stiffness"
    )
    assert mf.design(points, template()).misfit < 1e-9
    assert mf.design(mf.PowerLaw(0.6, (0.05, 0.2), of="stiffness"), template()).misfit < 5e-3
    middle = predicted(known(), "conductance")
    band = mf.Band(LOADS, 0.97 * middle, 1.03 * middle, of="conductance")
    found = mf.design(band, template())
    assert found.misfit == 0.0
    assert found.parameters["band_margin"] > 0.8


def test_tools_reach_a_stiffness(tmp_path):
    wanted = predicted(known().replaced(radius=0.3), "stiffness")
    design = mf.design(mf.SampledLaw(LOADS, wanted, of="stiffness"), template(), tools=[0.3, 0.526])
    assert design.misfit <= 5e-3
    mf.save(design, tmp_path / "out")
    assert mf.load(tmp_path / "out") == design


def test_plastic_contacts_conduct():
    model = mf.Independent(mf.KogutEtsion(10.0))
    wanted = predicted(known(), "conductance", model)
    assert mf.design(mf.SampledLaw(LOADS, wanted, of="conductance"), template(), model).misfit <= 5e-3


def test_a_plot_draws_the_quantity():
    design = mf.design(mf.PowerLaw(0.6, (0.05, 0.2), of="stiffness"), template())
    ax = design.plot()
    assert ax.get_ylabel() == "stiffness  k/E* [mm]"
    expected = mf.friction_law(design.surface, load=design.law.load).rescaled_stiffness
    assert_allclose(ax.lines[0].get_ydata()[-100:], expected, rtol=1e-12)


def test_heights_on_steps_and_prescribed_heights_follow_a_stiffness():
    target = mf.PowerLaw(0.55, (0.05, 0.2), of="stiffness")
    stepped = mf.design(target, template(), limits=mf.Limits(0.12, height_step=0.006))
    assert stepped.misfit < 0.01
    steps = stepped.surface.gap / 0.006
    assert_allclose(steps, np.rint(steps), atol=1e-9)
    pinned = mf.design(target, template(), limits=mf.Limits(0.12, pinned={0: 0.1, 3: None}))
    assert pinned.misfit < 5e-3
    assert pinned.surface.height[pinned.sites == 0] == [0.1]
