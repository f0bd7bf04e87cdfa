"""Expected numbers that no paper prints, from the printed equations with numpy and scipy alone."""

import numpy as np
import pytest
from scipy.optimize import brentq

from validation.paper import (
    contact_laws,
    fig3_operating_points,
    fig_s3_manufacturing,
    interaction_error,
)
from validation.paper.surfaces import surfaces
from validation.published import paper, table

RADIUS, COUNT = 0.526, 64


def hertz(height, separation):
    """Sums of area and rescaled load of independent Hertz contacts, eq. S1."""
    depth = np.clip(np.asarray(height) - separation, 0.0, None)
    return np.pi * RADIUS * depth.sum(), 4.0 / 3.0 * np.sqrt(RADIUS) * (depth**1.5).sum()


def separation_at(height, load):
    """Return the separation at a rescaled load."""
    return brentq(lambda d: hertz(height, d)[1] - load, max(height) - 1.0, max(height), xtol=1e-15)


def area_at(height, load):
    return hertz(height, separation_at(height, load))[0]


def test_levels_of_fig_3_solve_s1():
    points = paper()["fig3"]
    level, height = points["max_height_um"] / 1e3, []
    for i, (load, friction) in enumerate(zip(points["load_mm2"], points["friction_mm2"], strict=True)):
        assert 1e3 * level == pytest.approx(fig3_operating_points.LEVELS[i], abs=0.05)
        while area_at([*height, level], load) <= friction:
            height.append(level)
        highest = separation_at(height, load)

        def excess(added, height=tuple(height), load=load, friction=friction):
            return area_at([*height, added], load) - friction

        added = brentq(excess, highest, level, xtol=1e-15)
        assert 1e3 * added == pytest.approx(fig3_operating_points.ADJUSTMENTS[i], abs=0.05)
        height.append(added)
        level = separation_at(height, load)


def areas_at(height, load):
    """Areas of many lists of heights (m, n) at loads (k,), by bisection of the approach, (m, k)."""
    gap = (height.max(axis=1, keepdims=True) - height)[:, None, :]
    low, high = np.zeros((2, len(height), len(load), 1))
    high += 2.0 * height.max()
    for _ in range(45):
        middle = 0.5 * (low + high)
        depth = np.clip(middle - gap, 0.0, None)
        light = 4.0 / 3.0 * np.sqrt(RADIUS) * (depth * np.sqrt(depth)).sum(axis=2) < load
        low, high = np.where(light[..., None], (middle, high), (low, middle))
    return np.pi * RADIUS * np.clip(high - gap, 0.0, None).sum(axis=2)


@pytest.mark.slow
@pytest.mark.parametrize("colour", ["blue", "red"])
def test_scatter_of_fig_s3_is_that_of_draws(colour):
    """Four standard errors of 2,000 draws."""
    levels, printed = table("table_s1"), paper()["fig4"][colour]
    height = np.repeat(levels["height"], levels[f"count_{colour}"].astype(int)) / 1e3
    foot = {"blue": 0.1928, "red": 0.4814}[colour]  # eq. S2 at zero separation, as above
    load = np.linspace(0.25 * foot, foot, 20)
    weight = (load - load.mean()) / ((load - load.mean()) ** 2).sum()
    assert len(height) == COUNT
    assert 1e3 * height.max() < printed["max_height_um"]
    error = np.random.default_rng(0).standard_normal((2000, COUNT))
    nominal = areas_at(height[None], load)[0] @ weight
    for sd, expected in zip((0.9e-3, 3e-3), fig_s3_manufacturing.SCATTER[colour], strict=True):
        slope = areas_at(height + sd * error, load) @ weight / nominal
        assert slope.std() == pytest.approx(expected, rel=4.0 / np.sqrt(2 * 2000))
        assert slope.mean() == pytest.approx(1.0, abs=0.002)


def test_point_loads_change_the_laws_of_figs_4_and_5_by_the_expected_rms():
    changes = []
    for name, surface in surfaces().items():
        if "3" in name:
            continue
        x = surface.position
        distance = np.hypot(*(x[:, None] - x).transpose(2, 0, 1))
        with np.errstate(divide="ignore"):
            influence = np.where(distance > 0.0, 1.0 / (np.pi * distance), 0.0)
        ratio = [
            coupled_area(surface.height, influence, load) / area_at(surface.height, load) - 1.0
            for load in interaction_error.LOADS
        ]
        changes.append(np.sqrt(np.mean(np.square(ratio))))
    assert min(changes) >= interaction_error.LOW
    assert max(changes) <= interaction_error.HIGH


def coupled_area(height, influence, load):
    """Area at a rescaled load if each contact is a point load on a half-space for the others."""
    sunk = height
    for _ in range(60):  # fixed-point iteration
        separation = separation_at(sunk, load)
        depth = np.clip(sunk - separation, 0.0, None)
        sunk = height - influence @ (4.0 / 3.0 * np.sqrt(RADIUS) * depth**1.5)
    return hertz(sunk, separation_at(sunk, load))[0]


def adhesive_sums(energy, modulus):
    """JKR's contacts on loading, which begin at indentation 0, by a table of the contact radius."""
    strength = 2.0 * np.pi * energy / modulus
    a = np.linspace((RADIUS**2 * strength) ** (1.0 / 3.0), 0.5, 200_001)  # from d = 0
    d = a**2 / RADIUS - np.sqrt(strength * a)
    load = 4.0 * a**3 / (3.0 * RADIUS) - 2.0 * a * np.sqrt(strength * a)
    return d, np.pi * a**2, load


def sphere_sums():
    a = np.linspace(1e-6, 0.45, 100_001)
    half = np.arctanh(a / RADIUS)
    return a * half, np.pi * a**2, (a**2 + RADIUS**2) * half - a * RADIUS


def lowest_area_at(depth, area, load, height, wanted):
    """A0 where the load on a rising plane first reaches those wanted; contacts may lower it as they begin."""
    gap = height.max() - height
    approach = np.sort(np.concatenate([np.linspace(0.0, 0.25, 20_001), gap, np.nextafter(gap, 0.0)]))
    total, found = np.zeros((2, len(approach)))
    for each in gap:
        inside = approach >= each
        total[inside] += np.interp(approach[inside] - each, depth, load)
        found[inside] += np.interp(approach[inside] - each, depth, area)
    highest = np.maximum.accumulate(total)
    step = np.searchsorted(highest, wanted)
    share = (wanted - total[step - 1]) / (total[step] - total[step - 1])
    return found[step - 1] + share * (found[step] - found[step - 1])


@pytest.mark.parametrize("name", ["w = 9 mJ/m²", "w = 27 mJ/m²", "spheres"])
def test_adhesion_and_spheres_change_the_laws_by_the_expected_rms(name):
    for label, surface in surfaces().items():
        modulus = surface.material.composite_modulus
        law = sphere_sums() if name == "spheres" else adhesive_sums(1e-6 * float(name.split()[2]), modulus)
        after = lowest_area_at(*law, surface.height, contact_laws.LOADS)
        before = np.array([area_at(surface.height, load) for load in contact_laws.LOADS])
        rms = 100.0 * np.sqrt(((after / before - 1.0) ** 2).mean())
        assert rms == pytest.approx(contact_laws.RMS[label, name], abs=0.005)
