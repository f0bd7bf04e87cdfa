"""Second methods share no code with the package that they judge, and agree with closed forms."""

import ast
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.reference import hertz
from validation import methods
from validation.methods import contact_equations, periodic_sums, two_contacts
from validation.methods.caps import Caps, areas

# Those of the package itself, which checks name as self-consistency.
OF_PACKAGE = ("equation_errors", "resolved_areas")
ALLOWED = ("numpy", "scipy", "validation.methods", "metafem.reference")
STANDARD = ("__future__", "collections", "functools", "itertools", "math", "typing")


def test_second_methods_import_numpy_scipy_and_closed_forms_alone():
    for file in Path(methods.__path__[0]).glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            names = [node.module] if isinstance(node, ast.ImportFrom) else []
            names += [each.name for each in node.names] if isinstance(node, ast.Import) else []
            for name in names if file.stem not in OF_PACKAGE else []:
                assert f"{name}.".startswith(tuple(f"{each}." for each in ALLOWED + STANDARD)), name


def test_two_contacts_have_the_limits_of_one_contact_and_of_point_loads():
    radius, approach = 0.526, 0.1
    wide = np.sqrt(radius * approach)
    alone = hertz(wide, radius)[0]
    load, area = two_contacts.pair(approach, radius, 1e7)
    assert load == pytest.approx(2.0 * alone, rel=1e-6)
    assert area == pytest.approx(2.0 * np.pi * wide**2, rel=1e-6)
    # each is lowered by P/(π r), and its load falls by 3/2 of the relative indentation
    lost = 1.0 - two_contacts.pair(approach, radius, 50.0)[0] / (2.0 * alone)
    assert lost == pytest.approx(1.5 * alone / (np.pi * 50.0 * approach), rel=2.0 * wide / 50.0)


CAPS = (mf.Paraboloid(), mf.Power(4.0), mf.Power(1.5, 0.7), mf.Sphere())
RADIUS, EXPONENT, COEFFICIENT = np.array([[0.526, 0.8, 0.4, 0.5], [2.0, 4.0, 1.5, 2.0], [0.5, 0.5, 0.7, 0.5]])
LOAD = np.linspace(0.01, 0.3, 8)


@pytest.mark.parametrize("substrate", ["half-space", "layer", "periodic"])
def test_sums_of_closed_forms_agree_with_metafem(substrate):
    rng = np.random.default_rng(0)
    i = rng.integers(0, 4, 16)
    surface = mf.Surface.square_lattice(
        0.1 + rng.exponential(0.02, 16), (4, 4), 1.5, radius=RADIUS[i], material=mf.Material(1.36),
        block=mf.Block(20.0, 20.0, 7.2), cap=[CAPS[k] for k in i],
    )  # fmt: skip
    caps = Caps(RADIUS[i], EXPONENT[i], COEFFICIENT[i], i == 3)
    curve = mf.Independent(contact=mf.Elastic()).curve(surface, LOAD)
    np.testing.assert_allclose(areas(caps, surface.height, LOAD), curve.area, rtol=1e-9)
    if substrate == "periodic":
        between = periodic_sums.influence(surface.position, 6.0, 6.0)
        surface = surface.replaced(cell=mf.PeriodicCell(6.0, 6.0))
    else:
        between = contact_equations.influence(surface, substrate)
    on = mf.BondedLayer() if substrate == "layer" else mf.HalfSpace()
    model = mf.Interacting(order=1, substrate=on, contact=mf.Elastic())
    found = [contact_equations.coupled(surface.height, caps, between, load).area for load in LOAD]
    np.testing.assert_allclose(found, model.curve(surface, LOAD).area, rtol=1e-9)
