"""Pages in a browser, wide, narrow and dark: no error, no request, no overflow, links lead somewhere."""

import re

import pytest

import metafem as mf
from validation.page import write_report
from validation.results import collected
from validation.scenes.browser import problems


@pytest.fixture(scope="module")
def look(browser):
    """A function that opens a file in each view, and asserts that nothing is wrong."""

    def call(*paths):
        assert problems(browser, *paths) == []

    return call


@pytest.fixture(scope="module")
def validated(tmp_path_factory):
    """The pages of two claims, of which the others were left out."""
    folder = tmp_path_factory.mktemp("validation")
    write_report(folder, collected(["bounds", "table_s1"], 1), ["fe_hertz"])
    return folder


def test_the_pages_of_the_validation_are_in_order_and_name_no_machine(look, validated):
    pages = sorted(validated.glob("*.html"))
    for path in pages:
        assert not re.search(r"/tmp/|/home/|/root/|0x[0-9a-f]{7,}", path.read_text("utf-8")), path
    look(*pages)


def test_a_report_with_studies_is_in_order(look, full_report):
    look(full_report)


def test_the_first_screen_of_a_report_says_what_matters(browser, demo_results):
    """The law with its target, the verdict and three numbers; the rest folds, and opens to 3,500 pixels."""
    folder, _ = demo_results("linear")
    page = browser.new_page(viewport={"width": 1200, "height": 800})
    try:
        page.goto((folder / "linear" / "report.html").as_uri())
        shown = (".verdict", ".law svg", ".numbers b >> nth=0", ".numbers b >> nth=2", ".before")
        boxes = [page.locator(each).bounding_box() for each in shown]
        assert max(box["y"] + box["height"] for box in boxes) < 800.0
        assert page.locator(".verdict").inner_text() == mf.load(folder / "linear").verdict
        assert page.locator(".numbers b").count() == 3
        tall = "document.documentElement.scrollHeight"
        assert page.evaluate(tall) < 1300
        page.evaluate("document.querySelectorAll('main details').forEach(each => each.open = true)")
        assert page.evaluate(tall) <= 3500
    finally:
        page.close()


@pytest.mark.nightly
def test_links_open_what_is_folded_and_prints_show_it(browser, validated):
    """The rows of a claim's checks stand in folded parts."""
    page = browser.new_page()
    try:
        address = (validated / "paper.html").as_uri()
        page.goto(address)
        place = page.locator("main details tr[id]").first
        anchor = place.get_attribute("id")
        assert not place.is_visible()
        page.emulate_media(media="print")
        assert place.is_visible()
        page.emulate_media(media="screen")
        page.goto(f"{address}#{anchor}")
        assert place.is_visible()
    finally:
        page.close()
