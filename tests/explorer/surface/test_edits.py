"""Edits of single sites, as the map asks for them."""

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.surface.sites_text import asked_sites, edited, kept_height, typed_height
from metafem.files import demo_text, parsed

TEXT = demo_text("operating-points")


@pytest.fixture(scope="module")
def design():
    return parsed(TEXT, {}).design()


def asked(design, action, sites, height="", text=TEXT):
    return asked_sites(edited(text, design, {"action": action, "sites": sites, "height": height}))


def test_the_height_that_is_shown_is_kept(design):
    site = int(design.sites[0])
    assert asked(design, "pin", [site]).pinned == {site: kept_height(design, site)}


def test_typed_heights_are_kept_at_all_selected_sites(design):
    assert asked(design, "pin", [3, 4], " 120.5 ").pinned == {3: "120.5 um", 4: "120.5 um"}
    assert asked(design, "pin", [3], "0.12 mm").pinned == {3: "0.12 mm"}
    assert asked(design, "pin", [3], "120,5").pinned == {3: "120.5 um"}


def test_sites_are_emptied_and_released(design):
    text = edited(TEXT, design, {"action": "empty", "sites": [3, 4], "height": ""})
    assert asked_sites(text).empty == {3, 4}
    assert asked(design, "release", [4], text=text).empty == {3}


def test_empty_sites_have_no_height_to_keep(design):
    empty = next(site for site in range(64) if site not in design.sites)
    with pytest.raises(InvalidInput, match="no height that could be kept"):
        asked(design, "pin", [empty])


@pytest.mark.parametrize("typed", ["tall", "-3", "µm"])
def test_a_typed_height_must_begin_with_a_number(typed):
    with pytest.raises(InvalidInput, match="must be a number of micrometres"):
        typed_height(typed)


@pytest.mark.parametrize(
    "given",
    [
        None, [], "pin", {}, {"action": "pin", "sites": [], "height": ""},
        {"action": "shave", "sites": [1], "height": ""}, {"action": "pin", "sites": [64], "height": ""},
        {"action": "pin", "sites": [True], "height": ""}, {"action": "pin", "sites": [1], "height": 3},
        {"action": "pin", "sites": 3, "height": ""}, {"action": ["pin"], "sites": [1], "height": ""},
    ],
)  # fmt: skip
def test_events_of_a_wrong_kind_are_refused(design, given):
    with pytest.raises(InvalidInput, match="select them again"):
        edited(TEXT, design, given)
    with pytest.raises(InvalidInput, match="no surface yet"):
        edited(TEXT, None, given)
