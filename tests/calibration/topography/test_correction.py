"""Systematic height errors are found, and corrected heights give the designed ones."""

import numpy as np
import pytest

import metafem as mf
from tests.calibration.topography.scenes import lattice, made_surface

TRUE = {"offset": 3e-3, "scale": -0.02, "tilt_x": 4e-4, "tilt_y": -6e-4}


def systematic(surface, design, true=TRUE):
    x, y = (surface.position - design.position.mean(axis=0)).T
    return (
        true["offset"]
        + true["scale"] * (surface.height - design.height.mean())
        + true["tilt_x"] * x
        + true["tilt_y"] * y
    )


def test_a_part_made_with_exact_corrected_heights_is_the_design():
    design = lattice(np.random.default_rng(0))
    made = made_surface(design, systematic(design, design), sd=0.0)
    correction = mf.calibration.corrected_heights(design, made)
    again = correction.surface.height + systematic(correction.surface, design)
    np.testing.assert_allclose(again, design.height, atol=1e-13)
    assert correction.expected_error < 1e-12


def test_terms_and_random_errors_of_many_parts():
    rng = np.random.default_rng(1)
    scores, kept, random, seen = [], [], [], []
    for _ in range(60):
        design = lattice(rng)
        made = made_surface(design, systematic(design, design) + rng.normal(0.0, 0.9e-3, 64))
        correction = mf.calibration.corrected_heights(design, made)
        kept.append(correction.terms)
        found = dict(
            zip(correction.terms, zip(correction.value, correction.value_sd, strict=True), strict=True)
        )
        scores += [(found[name][0] - value) / found[name][1] for name, value in TRUE.items()]
        random.append(correction.random_sd)
        again = correction.surface.height + systematic(correction.surface, design)
        again += rng.normal(0.0, 0.9e-3, 64)
        seen.append(((again - design.height) ** 2).mean() / correction.expected_error**2)
    # 240 values of s.d. 1: their s.d. within three of its standard errors, 1 / sqrt(480)
    assert np.std(scores) == pytest.approx(1.0, abs=3.0 / np.sqrt(480))
    # a group that is not there is kept in one of a hundred parts
    assert sum("bow_xx" in terms for terms in kept) <= 4
    assert all(set(TRUE) <= set(terms) for terms in kept)
    # 60 parts of 60 degrees of freedom each: 1.2 % standard error
    assert np.sqrt(np.mean(np.square(random))) == pytest.approx(0.9e-3, rel=0.04)
    assert np.mean(seen) == pytest.approx(1.0, rel=0.1)


def test_random_errors_alone_are_not_corrected():
    rng = np.random.default_rng(2)
    design = lattice(rng)
    error = rng.normal(0.0, 0.9e-3, 64)
    correction = mf.calibration.corrected_heights(design, made_surface(design, error))
    assert correction.terms == ()
    np.testing.assert_array_equal(correction.surface.height, design.height)
    assert correction.expected_error == pytest.approx(0.9e-3, rel=0.2)


def test_a_bow_is_found_and_a_missing_asperity_is_corrected_too():
    rng = np.random.default_rng(3)
    design = lattice(rng)
    bow = 1e-4 * (design.position**2).sum(axis=1)
    site = np.arange(1, 64)
    made = made_surface(design, bow[1:], sd=0.0, site=site)
    correction = mf.calibration.corrected_heights(design, made)
    np.testing.assert_allclose(correction.surface.height, design.height - bow, atol=1e-12)
    assert "1 of the asperities were not measured" in str(correction.notes[0])


def test_few_asperities_of_one_height_determine_only_an_offset():
    design = mf.Surface.square_lattice(0.1, (1, 3), radius=0.526, material=mf.Material(1.36))
    correction = mf.calibration.corrected_heights(design, made_surface(design, np.full(3, 2e-3), sd=0.0))
    assert correction.terms == ("offset",)
    assert "scale, tilt, bow" in str(correction.notes[0])


def test_radii_and_impossible_heights_are_noted():
    design = mf.Surface.square_lattice([0.001, 0.1, 0.1], (1, 3), radius=0.526, material=mf.Material(1.36))
    made = made_surface(design, np.full(3, 2e-3), sd=0.0)
    made = type(made)(**{**vars(made), "surface": made.surface.replaced(radius=0.536)})
    text = "\n".join(map(str, mf.calibration.corrected_heights(design, made).notes))
    assert "the radii are 0.01 mm larger than designed (1.9 %)" in text
    assert "the corrected height of asperity 0 is -0.001 mm: it cannot be made" in text


def test_a_design_can_be_saved_with_corrected_heights(tmp_path):
    template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
    design = mf.design(mf.LinearLaw(6.87), template)
    made = made_surface(design.surface, np.full(design.surface.count, -1e-4), sd=1e-6)
    correction = mf.calibration.corrected_heights(design, made)
    mf.save(correction.design, tmp_path / "next")
    stored = mf.load(tmp_path / "next")
    np.testing.assert_allclose(stored.surface.height, design.surface.height + 1e-4, rtol=1e-12)
    assert "the heights are those to make next" in str(stored.notes[-1])


FEW = mf.Surface.square_lattice(0.1, (1, 2), radius=0.526, material=mf.Material(1.36))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"design": None}, "metafem.Surface or a metafem.Design"),
        ({"made": None}, "MadeSurface"),
        ({"design": lattice(np.random.default_rng(5))}, "pass made.design"),
        ({"design": FEW, "made": made_surface(FEW, np.zeros(2))}, "2 asperities"),
    ],
)
def test_what_cannot_be_corrected_is_refused(change, message):
    design = lattice(np.random.default_rng(4))
    given = {"design": design, "made": made_surface(design, np.zeros(64)), **change}
    with pytest.raises(mf.InvalidInput, match=message):
        mf.calibration.corrected_heights(**given)
