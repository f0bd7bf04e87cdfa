"""Studies and calibration refuse asperities that differ in friction."""

import numpy as np
import pytest

import metafem as mf

MATERIAL = mf.Material(1.36)
WORDS = r"friction\.shear_strength has one value for each asperity, which {} does not support; use one"


@pytest.fixture(scope="module")
def coated():
    friction = mf.Friction([0.4, 0.1, 0.2, 0.4], 0.85)
    template = mf.Surface.square_lattice(
        0.12, (2, 2), radius=0.526, material=MATERIAL, friction=friction, block=mf.Block(20, 20, 7.2)
    )
    return mf.design(mf.OperatingPoints([0.02, 0.04], [0.08, 0.15]), template, limits=mf.Limits(0.2))


@pytest.mark.parametrize(
    ("name", "study"),
    [
        ("the study manufacturing", lambda design: mf.studies.manufacturing(design.surface, [0.001])),
        ("the study misalignment", lambda design: mf.studies.misalignment(design.surface, [0.001])),
        (
            "the study uncertainty",
            lambda design: mf.studies.uncertainty(design.surface, {"radius": 0.005}, load=[0.03]),
        ),
        ("the study interaction", mf.studies.interaction),
        ("the study combined", lambda design: mf.studies.combined(design, mf.Tolerances(0.001))),
        (
            "a measured law",
            lambda design: mf.calibration.MeasuredLaw(
                [0.1, 0.2], friction_force=[0.1, 0.2], material=MATERIAL, friction=design.surface.friction
            ),
        ),
        (
            "metafem.calibration.explain",
            lambda design: mf.calibration.explain(
                mf.calibration.MeasuredLaw([0.1], asperity_area=[[0.1] * 4], material=MATERIAL), design
            ),
        ),
        (
            "metafem.calibration.shear_strength",
            lambda design: mf.calibration.shear_strength(
                mf.calibration.MeasuredLaw(
                    [0.1, 0.2, 0.3],
                    friction_force=[0.1, 0.2, 0.3],
                    material=MATERIAL,
                    friction=mf.Friction(0.4),
                ),
                design.surface,
                0.05,
            ),
        ),
    ],
)
def test_one_friction_is_needed(coated, name, study):
    with pytest.raises(mf.InvalidInput, match=WORDS.format(name)):
        study(coated)


def test_fidelity_compares_areas(coated):
    """The study of A0 needs no friction."""
    one = mf.friction_law(coated.surface.replaced(friction=None), load=coated.law.load)
    np.testing.assert_allclose(one.area, coated.law.area, rtol=1e-12)
    found = mf.studies.fidelity(coated, elements=False)
    np.testing.assert_allclose(found.area.sel(model="independent"), one.area, rtol=1e-12)
