"""Pages in a browser, wide, narrow and dark: no error, no request, no overflow, links lead somewhere."""

from dataclasses import replace
from itertools import cycle

import pytest

import metafem as mf
from metafem.report import page
from validation.chapters import CHAPTERS
from validation.page import write_report
from validation.results import collected
from validation.scenes.browser import problems
from validation.verdicts import QUESTIONS


@pytest.fixture(scope="module")
def look(browser):
    """A function that opens a file in each view, and asserts that nothing is wrong."""

    def call(*paths):
        assert problems(browser, *paths) == []

    return call


def test_the_report_of_a_design_is_in_order(look, template, tmp_path):
    design = mf.design(mf.LinearLaw(6.87), template, limits=mf.Limits(0.12, offset=0.084))
    (tmp_path / "report.html").write_text(page(design), "utf-8")
    look(tmp_path / "report.html")


def test_what_is_wrong_with_a_page_is_found(browser, tmp_path):
    text = (
        '<!doctype html><p id="a">a</p><p id="a">b</p><div style="width: 500px; height: 20001px">wide</div>'
        '<img src="x.png"><a href="#b">c</a><a href="y.html">d</a><script>undefined.x</script>'
    )
    (tmp_path / "bad.html").write_text(text, "utf-8")
    found = "\n".join(problems(browser, tmp_path / "bad.html"))
    for words in (
        "px tall; at most 20000",
        "wider than its window of 390 px", "the anchor a stands twice", "x.png", "1 are broken", "error: ",
        "it has no title", "text of tone", "link to #b, whose anchor does not exist",
        "link to y.html, which does not exist",
    ):  # fmt: skip
        assert words in found


def test_the_pages_of_the_validation_are_in_order(look, tmp_path):
    write_report(tmp_path, collected(["bounds"], 1), ["fe_hertz"])
    look(tmp_path / "index.html", tmp_path / "paper.html")


def test_a_report_with_studies_and_finite_elements_is_in_order(look, full_report):
    look(full_report)


@pytest.mark.nightly
def test_the_whole_site_is_in_order(look, whole_site):
    pages = sorted(whole_site.rglob("*.html"))
    assert len(pages) > 20
    assert [path.name for path in pages if path.stat().st_size > 3e6] == []
    look(*pages)


def test_pages_of_whole_chapters_are_short_enough(browser, tmp_path, monkeypatch):
    """Each claim of the report has the texts, rows and figures of one of three claims of usual length.

    Differences from the paper are few: only these three claims have theirs.
    """
    words = {"headline": "In part", "answer": "A word. " * 50, "numbers": {}, "parts": {}}
    asked = {f"{name} in part": {**each, **words} for name, each in QUESTIONS.items()}
    monkeypatch.setattr("validation.verdicts.QUESTIONS", asked)
    known = collected(["table_s1", "fig4_linear", "fig5_bilinear"], 1)
    plain = [replace(each, rows=(*each.checks, *each.results)) for each in known.values()]
    usual, names = cycle(plain), [name for chapter in CHAPTERS for name in chapter.claims]
    write_report(tmp_path, {name: known.get(name) or replace(next(usual), name=name) for name in names})
    found = problems(browser, *tmp_path.glob("*.html"))  # the pictures' anchors stand there several times
    assert [each for each in found if "px tall" in each] == []


@pytest.mark.nightly
def test_links_open_what_is_folded_and_prints_show_it(browser, whole_site):
    """The rows of a claim's checks, and the members of a class, stand in folded parts."""
    page = browser.new_page()
    try:
        for name, folded in (("paper.html", "tr"), ("api/metafem.html", ".member")):
            address = (whole_site / name).as_uri()
            page.goto(address)
            place = page.locator(f"main details {folded}[id]").first
            anchor = place.get_attribute("id")
            assert not place.is_visible()
            page.emulate_media(media="print")
            assert place.is_visible()
            page.emulate_media(media="screen")
            page.goto(f"{address}#{anchor}")
            assert place.is_visible()
    finally:
        page.close()
