"""Kept heights and empty sites in the text of a specification."""

import tomllib

import pytest

from metafem.explorer.surface.sites_text import asked_sites, with_sites
from metafem.files import demo_text

TEXT = demo_text("operating-points")


def test_kept_and_empty_sites_are_read_back():
    text = with_sites(with_sites(TEXT, {12: "120.5 um", 9: "0.15 mm"}), {}, empty=[3])
    asked = asked_sites(text)
    assert asked.pinned == {9: "0.15 mm", 12: "120.5 um"}
    assert asked.empty == {3}
    table = tomllib.loads(text)
    assert table.pop("sites") == {"empty": [3], "pinned": [9, 12], "heights": ["0.15 mm", "120.5 um"]}
    assert table == tomllib.loads(TEXT)


def test_a_site_is_kept_or_empty_or_free():
    text = with_sites(TEXT, {3: "100 um", 4: "110 um"})
    emptied = with_sites(text, {}, empty=[3])
    assert asked_sites(emptied).pinned == {4: "110 um"}
    assert asked_sites(with_sites(emptied, {3: "90 um"})).empty == set()
    assert asked_sites(with_sites(emptied, {}, free=[3, 4])) == asked_sites(TEXT)
    assert "sites" not in tomllib.loads(with_sites(text, {}, free=[3, 4]))


@pytest.mark.parametrize(
    "section",
    [
        "sites = 3",
        "[sites]\nempty = 'all'",
        "[sites]\npinned = [1, 2]",
        "[sites]\npinned = {a = 1}",
        "[sites",
    ],
)
def test_entries_of_a_wrong_kind_are_left_out(section):
    asked = asked_sites(section)
    assert (asked.empty, asked.pinned) == (set(), {})
