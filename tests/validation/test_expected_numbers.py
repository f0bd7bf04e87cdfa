"""Expected numbers that no paper prints, from the printed equations with numpy and scipy alone."""

import numpy as np
import pytest
from scipy.optimize import brentq

from validation.paper import (
    contact_laws,
    interaction_error,
)
from validation.paper.surfaces import surfaces

RADIUS = 0.526


def hertz(height, separation):
    """Sums of area and rescaled load of independent Hertz contacts, eq. S1."""
    depth = np.clip(np.asarray(height) - separation, 0.0, None)
    return np.pi * RADIUS * depth.sum(), 4.0 / 3.0 * np.sqrt(RADIUS) * (depth**1.5).sum()


def separation_at(height, load):
    """Return the separation at a rescaled load."""
    return brentq(lambda d: hertz(height, d)[1] - load, max(height) - 1.0, max(height), xtol=1e-15)


def area_at(height, load):
    return hertz(height, separation_at(height, load))[0]


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
