"""Robust designs: closed forms, gains on other draws, and where there is none."""

import math

import numpy as np
import pytest
from numpy.polynomial.hermite_e import hermegauss

import metafem as mf
from metafem.inversion.adjustment.robustness import _orthogonal

SOFT = mf.Material(1.36, 0.5)
BLOCK = mf.Block(20.0, 20.0, 7.2)
TEMPLATE = mf.Surface.square_lattice(0.12, radius=0.526, material=SOFT, block=BLOCK)

# the source paper's heights have a scatter of about 3 um
TOLERANCES = mf.Tolerances(height_sd=0.003, angle=math.radians(0.05))
LAWS = {"6.87": mf.LinearLaw(6.87), "9.46": mf.LinearLaw(9.46), "power": mf.PowerLaw(1.1, (0.05, 0.2))}


def expected(design, rng, draws=1000):
    """Squared misfits of made surfaces, by errors that are drawn here; the mean of both signs, (m,)."""
    surface, law, random = design.surface, design.target_law, np.random.default_rng(rng)
    error = 0.003 * random.standard_normal((draws, surface.count))
    error = error + np.tan(random.uniform(-1, 1, (draws, 2)) * math.radians(0.05)) @ surface.position.T
    height = surface.height + np.concatenate([error, -error])
    area = design.law.model.areas(surface, law.load, height)
    return np.array([law.misfit(row) ** 2 for row in area]).reshape(2, -1).mean(axis=0)


def test_fixed_errors_have_unit_mean_squares():
    lines = _orthogonal(5, 12, 100, np.random.default_rng(0))
    assert lines.shape == (15, 5)
    np.testing.assert_allclose(lines.T @ lines / 15, np.eye(5), atol=1e-12)
    assert _orthogonal(300, 32, 128, np.random.default_rng(0)).shape == (128, 300)


def test_two_asperities_have_the_expected_misfit_of_a_quadrature():
    pair = mf.Surface.square_lattice(0.12, (1, 2), radius=0.526, material=SOFT)
    true = pair.replaced(height=[0.12, 0.09])
    load = np.linspace(0.03, 0.06, 5)
    target = mf.SampledLaw(load, mf.Independent().curve(true, load).area)
    tolerances = mf.Tolerances(height_sd=0.003)
    found = mf.design(target, pair, robust=tolerances)
    # only the difference of the heights matters, whose standard deviation is sqrt(2) times that of a height
    node, weight = hermegauss(40)
    difference = 0.03 + math.sqrt(2.0) * 0.003 * node
    areas = [mf.Independent().curve(pair.replaced(height=[0.12, 0.12 - d]), load).area for d in difference]
    squares = np.array([target.curve().misfit(area) ** 2 for area in areas])
    mean, square = weight @ squares / weight.sum(), weight @ squares**2 / weight.sum()
    # a mean over 1000 pairs has at most the error of 1000 draws
    error = math.sqrt((square - mean**2) / 1000)
    assert found.parameters["plain_expected_misfit"] ** 2 == pytest.approx(mean, abs=3.0 * error)


def test_errors_of_a_single_contact_cannot_be_reduced():
    one = mf.Surface.square_lattice(0.1, (1, 1), radius=0.526, material=SOFT)
    target = LAWS["6.87"]
    plain = mf.design(target, one)
    found = mf.design(target, one, robust=mf.Tolerances(height_sd=0.003))
    # its law does not depend on the height
    area = mf.Independent().curve(plain.surface, plain.target_law.load).area
    assert found.parameters["expected_misfit"] == pytest.approx(plain.target_law.misfit(area), rel=1e-6)
    assert found.parameters["robust_gain"] == found.parameters["irreducible_share"] == 0.0
    assert found.surface == plain.surface
    assert any("those of the plain design" in note.text for note in found.notes)


def assert_better(law, model=None):
    """Return a robust design whose made surfaces have a smaller expected misfit than those of a plain one."""
    plain, robust = (mf.design(law, TEMPLATE, model, robust=robust) for robust in (None, TOLERANCES))
    gain = expected(plain, 99) - expected(robust, 99)
    assert gain.mean() > 3.0 * gain.std(ddof=1) / math.sqrt(len(gain))
    return robust


@pytest.mark.parametrize("law", ["9.46", "power"])
def test_made_surfaces_have_a_smaller_expected_misfit(law):
    robust = assert_better(LAWS[law])
    stated = robust.parameters
    assert stated["robust_gain"] > 3.0 * stated["robust_gain_error"]
    assert stated["expected_misfit"] == pytest.approx(math.sqrt(expected(robust, 98).mean()), rel=0.05)
    assert 0.5 < stated["irreducible_share"] < 1.0
