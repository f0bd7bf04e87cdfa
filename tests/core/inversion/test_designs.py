"""The contract of designs: each kind of target on a lattice, with tools, on steps and with fixed heights."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus

LATTICE = mf.Surface.square_lattice(0.12, (3, 3), radius=0.526, material=mf.Material(1.36))
LOAD = np.array([0.003, 0.006, 0.012, 0.024])
AREA = mf.Independent().curve(LATTICE.replaced(height=0.12 - 0.006 * np.arange(9)), LOAD).area
TARGETS = {
    "points": mf.OperatingPoints(LOAD[1:], AREA[1:]),
    "sampled": mf.SampledLaw(LOAD, AREA),
    "band": mf.Band(LOAD, 0.97 * AREA, 1.03 * AREA),
    "power": mf.PowerLaw(0.8, (0.006, 0.024)),
    "multilinear": mf.MultilinearLaw([7.5, 6.5], [(0.01, 0.012)], (0.006, 0.02)),
    "line": mf.LinearLaw(8.5, (0.012, 0.02)),
    "two lines": mf.BilinearLaw((8.0, 9.0), 0.015, (0.012, 0.02)),
    "density": mf.LinearLaw(5.5),
    "two densities": mf.BilinearLaw((8.0, 7.0), 0.02),
}
TOOLS = [mf.Tool(0.526), mf.Tool(0.3, mf.Power(3))]
PINNED = {1: 0.11, 5: None}


def misfit(found):
    """The misfit of a design by its definition, from the friction law of its surface."""
    law, target = found.target_law, found.target

    def friction(load):
        return mf.friction_law(found.surface, found.law.model, load=1.36 * load).rescaled_friction

    area = friction(law.load)
    if isinstance(target, mf.Band):
        return float(((area < target.lowest) | (area > target.highest)).any())
    difference = area / law.law(area) - 1.0
    if law.pointwise:
        return np.abs(difference).max()
    slopes = [np.polyfit(b.load, friction(b.load), 1)[0] / b.slope - 1.0 for b, _ in found.fits]
    return max([np.sqrt((law.weight * difference**2).mean()), *np.abs(slopes)])


def assert_met(name, found, exact=True):
    """The stated misfit is that of the surface, and within what its kind of target promises."""
    assert misfit(found) == pytest.approx(found.misfit, rel=1e-9, abs=1e-12)
    assert found.misfit <= (0.1 if found.density else 1e-9 if name == "points" and exact else 0.01)
    assert found.status is not DesignStatus.MISSED
    assert found.surface.height.max() <= found.limits.top * (1.0 + 1e-12)
    assert found.surface.height.min() >= found.limits.foot * (1.0 - 1e-12)
    np.testing.assert_array_equal(found.surface.position, LATTICE.position[found.sites])


@pytest.mark.parametrize("name", TARGETS)
def test_on_a_lattice(name):
    found = mf.design(TARGETS[name], LATTICE, limits=mf.Limits(0.12, offset=0.04))
    assert_met(name, found)
    np.testing.assert_array_equal(found.surface.radius, 0.526)


@pytest.mark.parametrize("name", ["density", "two densities"])
def test_a_density_has_one_of_the_radii(name):
    found = mf.design(TARGETS[name], LATTICE, limits=mf.Limits(0.12), tools=[0.3, 0.526])
    assert_met(name, found)
    assert set(found.surface.radius) in ({0.3}, {0.526})


# its search ends by restarts that agree, after two seconds
SLOW = pytest.param("multilinear", marks=pytest.mark.slow)


@pytest.mark.parametrize("name", ["points", "sampled", "band", SLOW, "line"])
def test_with_tools(name):
    found = mf.design(TARGETS[name], LATTICE, limits=mf.Limits(0.12), tools=TOOLS)
    assert_met(name, found)
    made = [mf.Tool(r, found.surface.cap.one(i)) for i, r in enumerate(found.surface.radius)]
    assert [made.count(tool) for tool in TOOLS] == found.parameters["tool_counts"].tolist()
    assert sum(found.parameters["tool_counts"]) == found.surface.count


@pytest.mark.parametrize("name", TARGETS)
def test_on_steps(name):
    # few asperities have their density on coarse steps alone
    limits = mf.Limits(0.12, height_step=0.012 if name == "density" else 0.0005)
    found = mf.design(TARGETS[name], LATTICE, limits=limits)
    assert_met(name, found, exact=False)
    steps = found.surface.height / limits.height_step - 0.5
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-9)


@pytest.mark.parametrize("name", TARGETS)
def test_with_fixed_heights(name):
    found = mf.design(TARGETS[name], LATTICE, limits=mf.Limits(0.12, pinned=PINNED))
    assert_met(name, found)
    assert dict(found.pinned) == PINNED
    assert 5 not in found.sites
    np.testing.assert_array_equal(found.surface.height[found.sites == 1], [0.11])
