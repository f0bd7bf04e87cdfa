"""Wrong input of an inversion is refused by its name and value."""

from functools import partial

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import achievable_load_range
from metafem.inversion.density import ExponentialDensity
from metafem.inversion.wording import Wording
from tests.refusals import faults

PAIR = mf.Material(2.0), mf.Friction(0.5)
LATTICE = mf.Surface.square_lattice(0.12, (2, 3), radius=0.526, material=PAIR[0], friction=PAIR[1])
PART = LATTICE.replaced(block=mf.Block(20.0, 20.0, 7.0))
PERIODIC = LATTICE.replaced(cell=mf.PeriodicCell(4.5, 3.0))
BARE, STEPPED = LATTICE.replaced(friction=None), LATTICE.replaced(height=np.linspace(0.1, 0.12, 6))
POWER, RANGE = mf.PowerLaw(0.9, (0.1, 0.2)), mf.PowerRange(1.2, 6.0)
JKR, design = mf.JKR(9e-6), partial(mf.design, POWER, LATTICE)


def pinned(given, template=LATTICE):
    mf.design(POWER, template, limits=mf.Limits(0.12, offset=0.08, pinned=given))


def tools(*given, target=POWER, template=LATTICE, **options):
    mf.design(target, template, tools=given, **{"limits": mf.Limits(0.3), **options})


# The call, and two of the words of its error: the argument and the given value, or what limits it.
TARGETS = [
    (lambda: mf.OperatingPoints([1, 2], [1]), "rescaled_friction", "(1,)"),
    (lambda: mf.OperatingPoints([1, 1], [1, 2]), "rescaled_load[1]", "1"),
    (lambda: mf.OperatingPoints([1, 2], [2, 1]), "rescaled_friction[1]", "1"),
    (lambda: mf.LinearLaw(np.nan), "slope", "nan"),
    (lambda: mf.LinearLaw(7.0, (0.2, 0.1)), "load_range[1]", "0.1"),
    (lambda: mf.LinearLaw(7.0, wording="N"), "wording", "N"),
    (lambda: mf.LinearLaw.from_forces([1.0], [1.0], *PAIR), "load", "1 value"),
    (lambda: mf.LinearLaw.from_friction_coefficient(-1.0, *PAIR), "friction_coefficient", "-1"),
    (lambda: mf.LinearLaw.from_friction_coefficient(1.0, 1.36, PAIR[1]), "material", "1.36"),
    (lambda: mf.BilinearLaw((1, 2, 3), 0.1), "slopes", "(3,)"),
    (lambda: mf.BilinearLaw((1, -2), 0.1), "slopes[1]", "-2"),
    (lambda: mf.BilinearLaw((6.0, 9.0), 0.3, (0.1, 0.2)), "crossover_load", "0.3"),
    (lambda: mf.SampledLaw([0.2, 0.1], [1, 2]), "rescaled_load[1]", "0.1"),
    (lambda: mf.SampledLaw([0.1, 0.2], [2, 0]), "rescaled_friction[1]", "0"),
    (lambda: mf.SampledLaw([0.1, 0.2], [1, 2], None, [0.1, 1.05]), "relative_error[1]", "1.05"),
    (lambda: mf.SampledLaw([0.1, 0.2], [1, 2], [1, 0]), "weight[1]", "0"),
    (lambda: mf.PowerLaw(-1.0, (0.1, 0.4)), "exponent", "-1"),
    (lambda: mf.MultilinearLaw([1, -2], [0.2], (0.1, 0.4)), "slopes", "-2"),
    (lambda: mf.MultilinearLaw([1, 2], [], (0.1, 0.4)), "crossover_loads", "1"),
    (lambda: mf.MultilinearLaw([1, 2], [(0.1, 0.2, 0.3)], (0.1, 0.4)), "crossover_loads[0]", "(3,)"),
    (lambda: mf.MultilinearLaw([1, 2], [0.5], (0.1, 0.4)), "0.5", "0.4"),
    (lambda: mf.Band([0.1, 0.2], [0.5, 0.9], [0.6, 0.9]), "lowest", "highest"),
    (lambda: Wording(-1.0), "composite_modulus", "-1"),
    (lambda: ExponentialDensity(0.04, 0.12, 0.12, 0.5), "crossover_height", "0.12"),
    (lambda: ExponentialDensity(0.04, 0.12, 0.01, 5.0), "3.836", "asperities"),
    (lambda: ExponentialDensity(0.04, 0.12).moment(1.0, 0.2), "separation", "0.2"),
]
DESIGNS = [
    (lambda: mf.design("linear", LATTICE), "target", "linear"),
    (lambda: mf.design(POWER, 3), "template", "3"),
    (lambda: design(limits=0.1), "limits", "0.1"),
    (lambda: mf.design(POWER, LATTICE.replaced(radius=np.linspace(1, 2, 6))), "radius", "tools"),
    (lambda: mf.design(POWER, LATTICE.replaced(cap=[mf.Power(2), mf.Sphere()] * 3)), "cap", "tools"),
    (lambda: mf.Limits(0.0), "max_height", "0"),
    (lambda: mf.Limits(0.1, min_height=0.2), "min_height", "0.2"),
    (lambda: mf.Limits(0.1, height_step=0.2), "height_step", "0.2"),
    (lambda: mf.Limits(0.1).levels, "height_step", "None"),
    (lambda: pinned([3]), "pinned", "[3]"),
    (lambda: pinned({6: None}), "pinned[6]", "0 to 5"),
    (lambda: pinned({True: None}), "pinned[True]", "0 to 5"),
    (lambda: pinned({2: 0.21}), "pinned[2]", "0.21"),
    (lambda: pinned({2: -0.01}), "pinned[2]", "-0.01"),
    (lambda: pinned(dict.fromkeys(range(6))), "pinned", "6 sites"),
    (lambda: pinned({2: 0.0}, PART), "pinned[2]", "0"),
    (lambda: mf.achievable_friction_coefficients(BARE, mf.Limits(0.1)), "template", "friction"),
    (lambda: achievable_load_range(POWER, LATTICE, mf.Limits(0.1)), "target", "PowerLaw"),
    (lambda: mf.plasticity_index(LATTICE, 0.0), "hardness", "0"),
    (lambda: mf.arrange(LATTICE, 0.1), "design", "Surface"),
    (lambda: mf.arrange(mf.design(POWER, LATTICE), 0.0), "tilt", "0"),
    (lambda: mf.arrange(mf.design(POWER, PERIODIC), 0.1), "cell", "tilt"),
]
TOOLS = [
    (lambda: tools(), "tools", "()"),
    (lambda: design(tools=3), "tools", "3"),
    (lambda: tools(0.3, -0.1), "tools[1]", "-0.1"),
    (lambda: tools(mf.Tool(0.3), "x"), "tools[1]", "x"),
    (lambda: mf.Tool(0.0), "radius", "0"),
    (lambda: mf.Tool(0.3, mf.Power(1.0)), "exponent", "1"),
    (lambda: mf.Tool(0.3, "sphere"), "cap", "sphere"),
    (lambda: mf.PowerRange(1.0, 3.0), "low", "1"),
    (lambda: mf.PowerRange(4.0, 3.0), "high", "3"),
    (lambda: mf.RadiusRange(0.3, 0.2), "high", "0.2"),
    (lambda: mf.RadiusRange(0.2, 0.8, 0.0), "step", "0"),
    (lambda: tools(mf.Tool(0.9, mf.Power(4)), mf.Tool(0.3)), "foot 1.6", "1.5 mm"),
    (lambda: tools(mf.Tool(0.2), mf.Tool(0.5, mf.Power(4))), "0.2 mm", "limits"),
    (lambda: design(mf.Independent(), tools=RANGE), "contact", "Elastic()"),
    (lambda: design(mf.Independent(mf.JKR(9e-6, mf.Elastic())), tools=RANGE), "range", "adhesion"),
]


@pytest.mark.parametrize("rows", [TARGETS, DESIGNS, TOOLS], ids=["targets", "designs", "tools"])
def test_wrong_input_is_refused_with_its_name_and_value(rows):
    assert faults(rows) == []
