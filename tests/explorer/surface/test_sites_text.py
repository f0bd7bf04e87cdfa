"""Kept heights and empty sites in the text of a specification."""

import pytest

from metafem.explorer.surface.sites_text import asked_sites, emptied_text, pinned_text, released_text
from metafem.files import demo_text

TEXT = demo_text("operating-points")


def test_kept_and_empty_sites_are_read_back():
    text = emptied_text(pinned_text(TEXT, {12: "120.5 um", 9: "0.15 mm"}), [3])
    asked = asked_sites(text)
    assert asked.pinned == {9: "0.15 mm", 12: "120.5 um"}
    assert asked.empty == {3}
    assert [line for line in TEXT.splitlines() if line not in text] == []


def test_a_site_is_kept_or_empty_or_free():
    text = pinned_text(TEXT, {3: "100 um", 4: "110 um"})
    assert asked_sites(emptied_text(text, [3])).pinned == {4: "110 um"}
    assert asked_sites(pinned_text(emptied_text(text, [3]), {3: "90 um"})).empty == set()
    assert asked_sites(released_text(emptied_text(text, [3]), [3, 4])) == asked_sites(TEXT)


@pytest.mark.parametrize("given", ["[10, 24, 60]", "[10,24,60]", "[ 10, 24, 60 ]"])
def test_lists_of_sites_are_written_with_spaces(given):
    text = f"[sites]\nempty = {given}  # by hand\n"
    for site in (5, 17, 70):
        line = emptied_text(text, [site]).splitlines()[1]
        listed = line.split(" = ")[1].split("  #")[0].strip("[] ")
        assert listed == ", ".join(map(str, sorted([10, 24, 60, site])))
        assert line.endswith("  # by hand")


def test_a_list_of_several_lines_keeps_them():
    text = "[sites]\nempty = [\n  10, # a,b\n  60,\n]\n"
    assert emptied_text(text, [17]) == text.replace("  60", "  17,\n  60")


def test_released_sites_leave_the_text_as_it_was():
    assert released_text(pinned_text(TEXT, {3: "100 um"}), [3]) == TEXT


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
