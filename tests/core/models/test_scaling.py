"""The same answer in other units: all lengths scaled by 1e-3 and 1e3, all moduli by 1e-6 and 1e6."""

import numpy as np
import pytest

import metafem as mf

LOAD = np.array([0.02, 0.1, 0.3])
SITES = np.array([[0.0, 0.0], [1.5, 0.1], [0.2, 1.6], [1.7, 1.4]])
HEIGHT = np.array([0.1, 0.12, 0.11, 0.125])
SCALES = [(1e-3, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6)]
CAPS = {"Hertz": (mf.Hertz(), mf.Sphere()), "power": (mf.Elastic(), mf.Power(4.0))}
MODELS = {
    "independent": lambda law, length: mf.Independent(law),
    "order 1": lambda law, length: mf.Interacting(1, contact=law),
    "order 3": lambda law, length: mf.Interacting(3, contact=law),
    "order 1, layer": lambda law, length: mf.Interacting(1, mf.BondedLayer(2.0 * length), law),
    "order 3, layer": lambda law, length: mf.Interacting(3, mf.BondedLayer(2.0 * length), law),
    "order 1, cell": lambda law, length: mf.Interacting(1, contact=law),
    "order 3, cell": lambda law, length: mf.Interacting(3, contact=law),
    "order 3, layer, cell": lambda law, length: mf.Interacting(3, mf.BondedLayer(2.0 * length), law),
    "resolved": lambda law, length: mf.BoundaryElements(0.025 * length, contact=law),
    "automatic": lambda law, length: mf.Automatic(1e-2, contact=law),
}


def answers(name, cap, length, modulus):
    """Approaches, areas and stiffnesses along a curve and at a load, over the unit of length."""
    law, shape = CAPS[cap]
    cell = mf.PeriodicCell(3.0 * length, 3.2 * length) if "cell" in name else None
    count, load = (2, LOAD[:2]) if name == "resolved" else (4, LOAD)
    sites, material = length * SITES[:count], mf.Material(1.36 * modulus)
    part = mf.Surface(sites, length * HEIGHT[:count], 0.526 * length, material, cap=shape, cell=cell)
    model, newtons = MODELS[name](law, length), length**2 * modulus * load
    curve = mf.friction_law(part, model, load=newtons)
    state = mf.equilibrium(part, model, load=float(newtons[1]))
    assert state.residual <= 1e-9
    return {
        "area": np.append(curve.area, state.asperity_area) / length**2,
        "load": np.append(curve.load, state.asperity_load) / (length**2 * modulus),
        "separation": np.append(curve.separation, state.separation) / length,
        "stiffness": np.array([state.stiffness / (length * modulus)]),
        "error": np.array([curve.model_error]),
    }


@pytest.mark.parametrize("cap", CAPS)
@pytest.mark.parametrize("name", MODELS)
def test_all_units_give_one_answer(name, cap):
    expected = answers(name, cap, 1.0, 1.0)
    for scale in SCALES:
        found = answers(name, cap, *scale)
        for key, value in expected.items():
            tolerance = 1e-6 if key == "error" else 1e-9
            np.testing.assert_allclose(
                found[key], value, rtol=tolerance, atol=1e-12, err_msg=f"{key} {scale}"
            )
