"""Errors of the made surface: theory, plain numpy and bad input."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.studies.draws import generator_of
from tests.conftest import MATERIAL, RADIUS


def test_plain_draws_are_those_of_numpy(linear):
    """The slope of each draw by a line fitted by numpy."""
    study = mf.studies.manufacturing(linear, 0.003, draws=64, rng=3)
    load, slopes = study.rescaled_load.values, []
    for z in generator_of(3, 0).standard_normal((64, 64)):
        area = mf.Independent().curve(linear.replaced(height=linear.height + 0.003 * z), load).area
        slopes.append(np.polyfit(load, area, 1)[0])
    assert study.slope_mean.item() == pytest.approx(np.mean(slopes), rel=1e-12)
    assert study.slope_sd.item() == pytest.approx(np.std(slopes, ddof=1), rel=1e-9)
    assert study.draws.item() == 64


def test_errors_of_one_asperity_are_exact():
    """A0 is proportional to R^(2/3), whose moments are those of a series to fourth order."""
    one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL)
    study = mf.studies.manufacturing(
        one, 0.0, draws=4096, others=mf.Tolerances(radius_sd=0.02), load_range=(0.01, 0.02)
    )
    s = 0.02 / RADIUS
    shift = (study.slope_mean / study.nominal_slope).item() - 1.0
    error = (study.slope_mean_error / study.nominal_slope).item()
    assert error < 5e-4
    assert shift == pytest.approx(-(s**2) / 9.0 - 7.0 / 81.0 * s**4, abs=4.0 * error)
    assert (study.slope_sd / study.nominal_slope).item() == pytest.approx(2.0 / 3.0 * s, rel=0.05)
    # A0(P) of a single contact is that of its radius: A0 = pi R^(2/3) (3 P / 4)^(2/3)
    one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL)
    study = mf.studies.manufacturing(one, 0.01, draws=50, load_range=(0.01, 0.02))
    assert_allclose(study.area_mean[0], np.pi * (RADIUS * 0.75 * study.rescaled_load) ** (2 / 3), rtol=1e-12)
    assert study.slope_sd.item() < 1e-12


def test_errors_of_equal_contacts_change_the_area_by_second_order():
    """Equal contacts of depth d: their linear response is zero, and only second order changes the area."""
    n, sd = 36, 1e-5
    flat = mf.Surface.square_lattice(0.2, (6, 6), radius=RADIUS, material=MATERIAL)
    study = mf.studies.manufacturing(flat, sd, draws=8192, load_range=(0.2, 0.3))
    depth = (0.75 * study.rescaled_load / n / np.sqrt(RADIUS)) ** (2 / 3)
    # A0 at fixed load changes by -pi R/(4 d) sum (dh - mean dh)^2
    assert_allclose(
        study.area_mean[0] - study.nominal_area, -np.pi * RADIUS / (4.0 * depth) * (n - 1) * sd**2, rtol=0.02
    )
    assert_allclose(
        study.area_sd[0], np.pi * RADIUS / (4.0 * depth) * np.sqrt(2.0 * (n - 1)) * sd**2, rtol=0.05
    )


def test_small_errors_have_the_linear_response(linear):
    model = mf.Independent()
    # no summit begins to touch near any of these loads
    slope = mf.studies.manufacturing(linear, 1e-8, draws=8192, model=model, load_range=(0.1, 0.2))
    load = slope.rescaled_load.values
    gradient = model.sensitivity(linear, load).gradient
    weight = (load - load.mean()) / ((load - load.mean()) ** 2).sum()
    assert slope.slope_sd.item() == pytest.approx(1e-8 * np.linalg.norm(weight @ gradient), rel=0.03)
    assert_allclose(slope.area_sd[0], 1e-8 * np.linalg.norm(gradient, axis=1), rtol=0.03)


def test_draws_without_a_solution_are_counted_and_left_out(linear, monkeypatch):
    whole = mf.studies.manufacturing(linear, 0.003, draws=320)
    areas, every = mf.Independent.areas, 10

    def failing(*given):
        found = areas(*given)
        found[::every, -1] = np.nan
        return found

    monkeypatch.setattr(mf.Independent, "areas", failing)
    study = mf.studies.manufacturing(linear, 0.003, draws=320)
    assert (study.failed.item(), study.draws.item()) == (33, 287)
    assert "warning: 33 draws have no solution" in study.attrs["notes"]
    assert_allclose(study.slope_sd, whole.slope_sd, rtol=0.1)
    assert np.isfinite(study.area_sd_error).all()
    every = 1
    with pytest.raises(mf.NotConverged, match=r"0\.003"):
        mf.studies.manufacturing(linear, 0.003, draws=32)


def test_a_study_states_where_its_numbers_come_from(linear):
    study = mf.studies.manufacturing(linear, [0.001, 0.002], draws=100, rng=5, load_range=(0.1, 0.2))
    assert {name: study.attrs[name] for name in ("study", "seed")} == {"study": "manufacturing", "seed": "5"}
    assert study.attrs["load_range"] == [0.1, 0.2]
    again = mf.studies.manufacturing(linear, [0.001, 0.002], draws=100, rng=5, load_range=(0.1, 0.2))
    assert study.identical(again)


def test_misfits_are_those_of_the_laws(design):
    sd, surface = 0.002, design.surface
    study = mf.studies.manufacturing(design, [0.0, sd], draws=40, load_range=(0.01, 0.03))
    found = []
    for z in generator_of(0, 0).standard_normal((40, surface.count)):
        made = surface.replaced(height=surface.height + sd * z)
        area = mf.Independent().curve(made, np.array([0.01, 0.03])).area
        found.append(np.abs(area / np.array([0.1, 0.26]) - 1.0).max())
    expected = np.quantile(found, [0.05, 0.5, 0.95], method="inverted_cdf")
    assert_allclose(study.misfit_quantile[1], expected, rtol=1e-9)
    assert_allclose(study.misfit_quantile[0], design.misfit, atol=1e-9)
