"""Expected numbers are those that the sources state, and no source claims to print what it does not."""

import pytest

from metafem.calibration.bounded_interval import PROBABILITY
from validation.check import Check, Difference
from validation.contact import plasticity
from validation.inversion import any_law, several_radii
from validation.page import MEANINGS
from validation.paper import contact_laws, fig1_flow, fig5_bilinear, fig_s2_misalignment
from validation.scenes import repeated_estimates
from validation.sources import Kind


def test_formulas_with_other_inputs_and_requirements_are_not_printed_in_the_paper():
    assert any_law.COEFFICIENT.kind is Kind.CLOSED_FORM
    assert fig1_flow.MADE.kind is Kind.KNOWN_INPUT
    assert plasticity.WARNED.kind is Kind.KNOWN_INPUT
    assert Kind.PAPER not in {row.source.kind for row in several_radii._coefficients()}
    assert "bound or rule" in MEANINGS[Kind.PAPER]


def test_the_expected_coverage_is_the_one_that_intervals_state():
    assert repeated_estimates.NOMINAL == PROBABILITY
    assert repeated_estimates.ALLOWED <= 0.02


def test_the_load_of_two_percent_is_the_root():
    assert contact_laws.one_contact()[2] == pytest.approx(0.10113, abs=1e-5)
    (check,) = (row for row in contact_laws._one_contact() if "at the load above which" in row.name)
    assert check.passed


def test_the_crossover_of_the_blue_surface_alone_is_a_difference():
    kinds = {
        colour: [isinstance(row, Difference) for row in fig5_bilinear._crossover(colour)]
        for colour in ("red", "blue")
    }
    assert not any(kinds["red"])
    assert kinds["blue"].count(True) == 1
    assert not any("standard deviations]" in row.name for row in fig5_bilinear._crossover("blue"))


def test_a_placement_beyond_the_stated_scatter_is_a_difference():
    assert isinstance(fig_s2_misalignment._as_designed("blue, 0.1°", 0.029, 0.021), Difference)
    below = fig_s2_misalignment._as_designed("red, 0.1°", 0.018, 0.021)
    assert isinstance(below, Check)
    assert below.passed
