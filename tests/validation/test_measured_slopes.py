"""The slopes of Figs. 4 and 5 by three contact laws, and the verdict that is made of them."""

import numpy as np
import pytest

from validation.check import reported
from validation.paper import measured_slopes as table
from validation.results import Evaluated
from validation.verdicts import Evidence, answer

NAME = "contact_laws"


def rows(hertz):
    """Rows of the claim that the verdict reads, with a largest difference of Hertz's law."""
    values = {
        "Fig. 4 blue, Hertz, σ as printed: slope minus the measured 1 ± 1 [s.d.]": hertz,
        "Fig. 4 blue, w = 9 mJ/m², σ as printed: slope minus the measured 1 ± 1 [s.d.]": 3.5,
        "Fig. 4 red, w = 9 mJ/m², σ as printed: slope minus the measured 1 ± 1 [s.d.]": 2.7,
        "Fig. 4 blue, w = 9 mJ/m², σ refitted: slope minus the measured 1 ± 1 [s.d.]": -1.1,
        **{
            f"Fig. 4 {colour}, w = 9 mJ/m², σ refitted at {over} times the load of full contact: "
            "slope minus the measured one [s.d.]": 0.5 * over
            for colour in ("blue", "red")
            for over in (1, 3)
        },
        "Fig. 5 red, w = 9 mJ/m²: largest change of A0 [%]": 16.3,
        "Fig. 5 red, slope 2, Hertz, σ as printed: slope over its target 1, minus 1 [%]": 4.0,
        "Fig. 5 red, slope 2, w = 9 mJ/m², σ as printed: slope over its target 1, minus 1 [%]": 20.0,
        "Fig. 5 red, slope 2, w = 9 mJ/m², σ refitted: slope over its target 1, minus 1 [%]": 10.0,
        "Fig. 5 red, w = 9 mJ/m²: rms change of A0 [%]": 6.0,
        "Fig. 5 red, w = 9 mJ/m², with interaction: rms change of A0 [%]": 60.0,
        "Fig. 5 red, w = 9 mJ/m², σ refitted: rms change of F [%]": 2.5,
    }
    return tuple(reported(name, value, "a method") for name, value in values.items())


def evidence(hertz):
    return Evidence({NAME: Evaluated(NAME, "Laws", "", "A text.", rows(hertz), (), 1.0)})


def test_the_verdict_follows_from_the_differences_of_the_measured_slopes():
    known = evidence(-0.5)
    headline, sentence = answer("contacts", known)
    assert headline == "For the slopes of Fig. 4, yes"
    assert not known.partly
    assert "misses them by up to 3.5 with σ as printed, by up to 1.1 with σ refitted" in sentence
    assert "and by up to 1.5 with another range of loads" in sentence
    assert "10 % with σ refitted, Hertz's law by 4 % with σ as printed (heights of Table S2; meas" in sentence
    assert "A0 by 6 to 6 % rms on Figs. 3 to 5, and by up to 16 % at one load" in sentence
    assert "the friction force by 2.5 to 2.5 % rms on Figs. 4 and 5" in sentence


def test_the_verdict_is_no_where_hertz_misses_a_measured_slope():
    known = evidence(1.2)
    assert answer("contacts", known)[0] == "Not for the slopes of Fig. 4"
    assert known.partly


def test_refitted_strength_leaves_the_forces_as_they_are():
    area = np.array([1.0, 1.5, 1.9])
    for ratio in (0.8, 1.0, 1.3):
        np.testing.assert_allclose(table.refitted(area, ratio * area) * ratio * area, area)


@pytest.mark.slow
def test_every_printed_slope_is_compared():
    found = table.branches()
    assert [found[f"Fig. 4 {colour}"][2:] for colour in ("blue", "red")] == [(9.53, 0.25), (6.73, 0.22)]
    assert sorted(each[2] for name, each in found.items() if "5" in name) == [7.15, 7.15, 12.52, 12.52]


def test_full_contact_begins_where_the_lowest_asperity_touches():
    surface = "Fig. 4 blue"
    height = table.surfaces()[surface].height
    # Hertz's loads of indentations from the lowest summit
    expected = 4.0 / 3.0 * np.sqrt(table.RADIUS) * ((height - height.min()) ** 1.5).sum()
    assert table.full_contact(surface)[[0, -1]] == pytest.approx([expected, 2.0 * expected])


@pytest.mark.slow
def test_adhesion_misses_the_slopes_of_fig_4_with_the_printed_strength_alone():
    for colour, high in (("blue", 3.5), ("red", 2.7)):
        name = f"Fig. 4 {colour}"
        assert table.deviation(name, table.ADHESION, table.PRINTED) == pytest.approx(high, abs=0.05)
        assert abs(table.deviation(name, table.ADHESION, table.REFITTED)) < 1.05
        assert abs(table.deviation(name, "Hertz", table.PRINTED)) < 0.8


@pytest.mark.slow
def test_hertz_fits_a_smaller_modulus_to_adhesive_contacts():
    assert table.softening(1.36) == pytest.approx(0.972, abs=0.002)
    assert table.softening(1e9) == pytest.approx(1.0, abs=1e-4)  # stiff contacts are those without adhesion
