"""Calls with the wrong arguments are answered in the package's words."""

import re

import pytest

import metafem as mf
from metafem._calls import checked_call

SURFACE = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: mf.friction_law(SURFACE, [0.1, 0.2]),
            r"model = \[0.1, 0.2\] must be a model such as metafem.Independent\(\); loads go by load=",
        ),
        (
            lambda: mf.friction_law(SURFACE, [0.1, 0.2], model=mf.MeanField()),
            r"friction_law: model is given twice; call friction_law\(surface, model, load=..., separation=",
        ),
        (
            lambda: mf.friction_law(SURFACE, None, [0.1]),
            "friction_law is given 3 arguments by position; call",
        ),
        (lambda: mf.friction_law(SURFACE, loads=[0.1]), "no argument loads; did you mean load?"),
        (lambda: mf.friction_law(), "friction_law: surface must be given"),
        (lambda: mf.equilibrium(SURFACE, 0.2), "model = 0.2 must be a model .* loads go by load="),
        (lambda: mf.equilibrium(SURFACE, 0.2, load=0.2, force=1), "equilibrium has no argument force"),
        (lambda: mf.design(mf.LinearLaw(7.0)), "design: template must be given"),
        (lambda: mf.design(mf.LinearLaw(7.0), SURFACE, limit=1), "no argument limit; did you mean limits?"),
        (lambda: mf.Surface([[0, 0]], [0.1]), "Surface: radius, material must be given; call Surface.posit"),
        (lambda: mf.Surface.square_lattice(0.1), "square_lattice: radius, material must be given"),
        (lambda: mf.Surface.square_lattice(0.1, pitsch=1), "no argument pitsch; did you mean pitch?"),
        (lambda: mf.save(), "save: design, folder must be given"),
        (
            lambda: mf.Material(young_modulus=3.0, poisson_ratio=0.3),
            r"Material has no argument young_modulus; call Material\.from_young\(young_modulus=",
        ),
        (lambda: mf.LinearLaw(friction_coefficient=1.5), r"LinearLaw\.from_friction_coefficient\("),
        (lambda: mf.Material(composit_modulus=3.0), r"did you mean composite_modulus\?"),
    ],
)
def test_the_error_of_a_wrong_call_states_the_signature(call, words):
    with pytest.raises(mf.InvalidInput, match=words):
        call()


def test_errors_within_a_function_are_not_changed():
    @checked_call
    def broken(value):
        return len(value)

    with pytest.raises(TypeError, match="has no len"):
        broken(3)
    assert broken([1]) == 1


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mf.LinearLaw(), "LinearLaw: slope must be given; call LinearLaw(slope, load_range"),
        (lambda: mf.LinearLaw(7.0, through_origin=True), "LinearLaw has no argument through_origin"),
        (lambda: mf.OperatingPoints([0.1, 0.2]), "rescaled_friction must be given"),
        (lambda: mf.Material(E=1.0), "Material has no argument E"),
        (lambda: mf.Limits(max_heigth=0.1), "did you mean max_height?"),
        (lambda: mf.Block(20.0, 20.0), "Block: thickness must be given"),
        (lambda: mf.Layout(seed=1), "Layout has no argument seed"),
        (lambda: mf.BoundaryElements(), "BoundaryElements: cell must be given"),
    ],
)
def test_constructors_raise_the_errors_of_the_package(call, message):
    with pytest.raises(mf.InvalidInput, match=re.escape(message)):
        call()
