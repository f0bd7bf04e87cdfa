"""Second methods share no code with the package that they judge, and agree with closed forms."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.reference.single_contacts import hertz
from validation import methods
from validation.methods import two_contacts
from validation.methods.caps import Caps, Tool
from validation.methods.coupled_caps import coupled, independent
from validation.methods.equation_errors import equation_error
from validation.methods.substrates import HalfSpace, Layer, PeriodicHalfSpace, point_loads

# Those of the package itself, which checks name as self-consistency.
OF_PACKAGE = ("equation_errors", "resolved_areas")
ALLOWED = ("numpy", "scipy", "validation.methods", "metafem.reference")
STANDARD = ("__future__", "collections", "dataclasses", "functools", "itertools", "math", "typing")


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


TOOLS = (Tool(0.526), Tool(0.8, 4.0), Tool(0.4, 1.5, 0.7), Tool(0.5, sphere=True))
CAPS = (mf.Paraboloid(), mf.Power(4.0), mf.Power(1.5, 0.7), mf.Sphere())
LOAD = np.linspace(0.01, 0.3, 8)
SUBSTRATES = {
    "half-space": (HalfSpace(), mf.HalfSpace(), None),
    "layer": (Layer(7.2), mf.BondedLayer(), None),
    "periodic": (PeriodicHalfSpace(6.0, 6.0), mf.HalfSpace(), mf.PeriodicCell(6.0, 6.0)),
}


@pytest.mark.parametrize("which", SUBSTRATES)
def test_sums_of_closed_forms_agree_with_metafem(which):
    own, theirs, cell = SUBSTRATES[which]
    rng = np.random.default_rng(0)
    index = rng.integers(0, 4, 16)
    surface = mf.Surface.square_lattice(
        0.1 + rng.exponential(0.02, 16), (4, 4), 1.5, radius=np.array([tool.radius for tool in TOOLS])[index],
        material=mf.Material(1.36), block=mf.Block(20.0, 20.0, 7.2), cap=[CAPS[i] for i in index],
    )  # fmt: skip
    caps = Caps.of(TOOLS, index)
    area = independent(caps, surface.height, LOAD)
    curve = mf.Independent(contact=mf.Elastic()).curve(surface, LOAD)
    np.testing.assert_allclose(area, curve.area, rtol=1e-9)
    area, load = coupled(caps, surface.height, LOAD, point_loads(own, surface.position))
    model = mf.Interacting(order=1, substrate=theirs, contact=mf.Elastic())
    np.testing.assert_allclose(
        area.sum(axis=1), model.curve(surface.replaced(cell=cell), LOAD).area, rtol=1e-9
    )
    np.testing.assert_allclose(load.sum(axis=1), LOAD, rtol=1e-12)


@pytest.mark.parametrize(
    "model",
    [mf.Independent(mf.JKR(9e-6)), mf.Interacting(1, mf.BondedLayer(), mf.KogutEtsion(3.0)),
     mf.Interacting(3, mf.BondedLayer()), mf.Interacting(3, contact=mf.SphericalCap(), pedestal=True)],
    ids=repr,
)  # fmt: skip
def test_a_solution_obeys_the_equations_and_a_changed_one_does_not(model):
    surface = mf.Surface.square_lattice(
        [0.1, 0.12, 0.11, 0.09], (2, 2), radius=0.526, material=mf.Material(1.36), block=mf.Block(9, 9, 3)
    )
    curve = model.curve(surface, np.array([0.1]))
    assert equation_error(surface, model, curve) < 1e-11
    # a shift of the plane by 1e-6 mm is an error of the order of the change
    assert equation_error(surface, model, replace(curve, approach=curve.approach + 1e-6)) > 1e-6
    moved = replace(curve.last, load=curve.last.load * np.array([1.0, 1.001, 1.0, 1.0]))
    assert equation_error(surface, model, replace(curve, compute_last=lambda: moved)) > 1e-4
