"""The surface of an answer as data of its pictures."""

import numpy as np
import pytest

from metafem.explorer.answer import Answer, answered
from metafem.explorer.session import State
from metafem.explorer.surface.sites_text import kept_height, with_sites
from metafem.explorer.surface.surface_data import layout_data, site_data
from metafem.files import demo_text

TEXT = demo_text("operating-points")


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT), 1)


def test_heights_stand_at_their_sites(answer):
    data, surface = site_data(answer), answer.design.surface
    heights = np.array([np.nan if each is None else each for each in data["height"]])
    assert len(heights) == answer.design.template.count
    assert np.flatnonzero(np.isfinite(heights)).tolist() == sorted(answer.design.sites)
    # half of the last decimal that is sent
    np.testing.assert_allclose(heights[answer.design.sites], 1e3 * surface.height, atol=0.005)
    assert data["limits"][0] <= np.nanmin(heights) <= np.nanmax(heights) <= data["limits"][1]
    assert data["radius"] == surface.radius[0]


def test_the_layout_is_that_of_the_template(answer):
    layout = layout_data(answer.design)
    assert len(layout["x"]) == len(layout["y"]) == 64
    assert layout["spacing"] == pytest.approx(1.5, rel=1e-12)
    assert layout["block"] == [20.0, 20.0, 7.2]


def test_a_kept_height_is_rounded_within_the_limits(answer):
    design = answer.design
    for site, height in zip(design.sites.tolist(), design.surface.height, strict=True):
        number, unit = kept_height(design, site).split()
        assert unit == "um"
        assert abs(float(number) - 1e3 * height) <= 0.1
        assert float(number) <= 1e3 * design.limits.max_height
    empty = next(site for site in range(64) if site not in design.sites)
    assert kept_height(design, empty) is None


def test_a_surface_that_is_older_says_so(answer):
    broken = answered(State(TEXT.replace("1.36 MPa", "1.36 mm")), 2, answer)
    data = site_data(broken)
    assert "last surface that was found" in data["message"]
    assert data["height"] == site_data(answer)["height"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (with_sites(TEXT, {3: "400 um"}), "sites.heights[0] = 400 um must be at most 270 um"),
        (with_sites(TEXT, dict.fromkeys(range(64), "200 um")), "the target law is missed by 121 %"),
        (with_sites(TEXT, {}, empty=range(1, 64)), "The reason is given in the plot of the law"),
    ],
)
def test_kept_heights_that_do_not_reach_the_target_say_so(answer, text, words):
    assert words in site_data(answered(State(text), 2, answer))["message"]


def test_empty_sites_of_the_text_are_named(answer):
    state = State(with_sites(TEXT, {}, empty=[5, 99]))
    data = site_data(Answer(3, state, answer.specification, answer.design))
    assert data["empty"] == [5]


def test_without_a_surface_there_is_only_a_message():
    data = site_data(answered(State("nothing"), 1))
    assert data == {"number": 1, "message": "There is no surface yet.", "old": False}
