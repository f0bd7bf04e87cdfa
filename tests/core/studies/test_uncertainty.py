"""Error bars against draws of laws, closed forms of small errors, and the shares of each parameter."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.uncertainty import LOADS, tabulated

SD = {"radius": 0.005, "composite_modulus": 0.04, "load": 0.005, "shear_strength": 0.006, "area_ratio": 0.01}
LOAD = np.array([0.05, 0.12, 0.2])


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(substrate=mf.BondedLayer())])
def test_moments_are_those_of_drawn_laws(surface, model):
    """Laws of 400 draws, each of a surface with its own material and radius."""
    found = mf.studies.uncertainty(surface, SD, model=model, load=LOAD)
    rng = np.random.default_rng(0)
    areas, forces, slopes = [], [], []
    for radius, modulus, load, strength, ratio in rng.standard_normal((400, 5)) * list(SD.values()):
        drawn = surface.replaced(
            radius=0.526 + radius,
            material=mf.Material(1.36 + modulus),
            friction=mf.Friction(0.404 + strength, 0.85 + ratio),
        )
        law = mf.friction_law(drawn, model, load=LOAD + load)
        areas.append(law.area)
        forces.append(law.friction_force)
        rescaled = np.linspace(*found.attrs["load_range"], 20)
        slopes.append(np.polyfit(rescaled, mf.friction_law(drawn, model, load=1.36 * rescaled).area, 1)[0])
    for name, values in (("area", areas), ("friction_force", forces), ("slope", slopes)):
        mean, sd = np.mean(values, axis=0), np.std(values, axis=0, ddof=1)
        # four standard errors of the draws, of which those of the study are a tenth
        assert (np.abs(found[f"{name}_mean"] - mean) <= 4.0 * sd / np.sqrt(400)).all()
        assert (np.abs(found[f"{name}_sd"] / sd - 1.0) <= 4.0 / np.sqrt(800)).all()
        assert (found[f"{name}_sd_error"] <= 0.006 * found[f"{name}_sd"]).all()


def test_small_errors_propagate_linearly(surface):
    small = {name: 1e-3 * sd for name, sd in SD.items()}
    found = mf.studies.uncertainty(surface, small, load=LOAD, draws=40_000)
    law, step = mf.friction_law(surface, load=LOAD), 1e-6
    moved = {
        "radius": mf.friction_law(surface.replaced(radius=0.526 + step), load=LOAD),
        "composite_modulus": mf.friction_law(surface.replaced(material=mf.Material(1.36 + step)), load=LOAD),
        "load": mf.friction_law(surface, load=LOAD + step),
    }
    relative = {name: small[name] * (moved[name].area / law.area - 1.0) / step for name in moved}
    relative |= {name: np.full(3, small[name] / getattr(surface.friction, name)) for name in list(SD)[3:]}
    variance = np.array([relative[name] ** 2 for name in SD])
    for name, of, nominal in (
        ("area", variance[:3], law.area), ("friction_force", variance, law.friction_force),
    ):  # fmt: skip
        sd = nominal * np.sqrt(of.sum(axis=0))
        assert (np.abs(found[f"{name}_sd"] - sd) <= 4.0 * found[f"{name}_sd_error"]).all()
        for index in ("first_order", "total"):
            share = found[f"{name}_{index}"].values
            error = 4.0 * found[f"{name}_{index}_error"].values + 1e-4
            assert (np.abs(share[: len(of)] - of / of.sum(axis=0)) <= error[: len(of)]).all()
            assert not share[len(of) :].any()
    assert not found.slope_total.sel(parameter="load").any()


def test_correlated_parameters_are_one_entry(surface):
    names, covariance = ["radius", "load", "composite_modulus"], np.diag([0.005**2, 0.005**2, 0.04**2])
    alone = mf.studies.uncertainty(surface, (names, covariance), load=LOAD)
    assert alone.equals(mf.studies.uncertainty(surface, {name: SD[name] for name in names}, load=LOAD))
    # the area of equal heights depends on R/E* alone, which keeps its value
    flat, sd = surface.replaced(height=np.full(16, 0.1)), 0.01 * np.array([0.526, 1.36])
    found = mf.studies.uncertainty(flat, (names[::2], np.outer(sd, sd)), load=LOAD)
    assert list(found.parameter.values) == ["radius + composite_modulus"]
    assert (found.area_sd < 1e-3 * 0.01 * found.area_mean).all()


def test_flat_surfaces_and_strengths_do_not_change_the_slope(surface):
    flat = surface.replaced(height=np.full(16, 0.1))
    found = mf.studies.uncertainty(flat, SD, draws=100)
    assert "slope_sd" not in found
    assert "no slope" in found.attrs["notes"]
    assert "slope_sd" in mf.studies.uncertainty(flat, SD, draws=100, load_range=(0.01, 0.1))
    found = mf.studies.uncertainty(surface, {"shear_strength": 0.006}, load=LOAD, draws=64)
    assert float(found.slope_sd) == 0.0
    assert (found.friction_force_sd > 0.0).all()
    assert found.friction_force_total.values == pytest.approx(1.0, abs=0.05)


def response_of(surface, model, radius_sd):
    """The response up to P/E* = 0.3 mm^2."""
    sd = {"radius": np.array([radius_sd * 0.526])}
    return tabulated(surface, model, sd, 0.3 * 1.36 * np.sqrt(1.0 - 5.0 * radius_sd))


@pytest.mark.parametrize(
    # the largest errors occur at the entry of a contact between two loads of the table
    ("model", "largest", "usual"),
    [(mf.Independent(), 1e-4, 1e-7), (mf.Interacting(substrate=mf.BondedLayer()), 5e-3, 1e-6)],
)
def test_the_area_is_that_of_the_model(surface, model, largest, usual):
    response = response_of(surface, model, 0.01)
    load = np.linspace(0.01, 0.28, 40)
    for factor in (0.975, 1.0, 1.015):
        area = model.areas(surface, load, surface.height[None], factor * surface.radius[None])[0]
        error = np.abs(response(load, np.full(40, factor)) / area - 1.0)
        assert error.max() <= largest
        assert np.median(error) <= usual


def test_there_is_no_area_without_load(surface):
    response = response_of(surface, mf.Independent(), 0.0)
    np.testing.assert_array_equal(response(np.array([-0.1, 0.0]), np.ones(2)), 0.0)


def test_a_load_without_solution_is_named(surface, monkeypatch):
    monkeypatch.setattr(mf.Interacting, "areas", lambda *given: np.full((1, LOADS), np.nan))
    with pytest.raises(mf.NotConverged, match="no solution at the rescaled load"):
        response_of(surface, mf.Interacting(), 0.01)
