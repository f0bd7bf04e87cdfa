"""Bad input to the page: texts that would be HTML, wrong files, and a field with an error."""

import pytest

from metafem.explorer.history import State, to_link
from metafem.explorer.table import Document
from metafem.files import demo_text
from tests.browser.hands import drop

pytestmark = pytest.mark.nightly

# What runs if a page takes it for HTML.
HTML = "</script><img src=x onerror='window.hacked=1'><script>window.hacked=1</script>"


@pytest.fixture
def visit(visit):
    """The page, which asks no other machine."""
    yield visit
    assert [each for each in visit.requests if not each.startswith(visit.server.origin)] == []


def test_no_text_is_taken_for_html(visit):
    page = visit.page
    visit.entered("lattice.pitch", HTML)
    page.locator(".chip", has_text="1 problem").wait_for()
    visit.entered("lattice.pitch", "1.5 mm")
    name = f"{HTML}.csv".replace("/", "")
    drop(visit, ".law-plot", name, b"a,b\n")
    page.locator(".law-live.wrong span", has_text="onerror").wait_for()
    table = b"load_N,friction_force_N\n0.1,0.12\n0.3,0.4\n"
    drop(visit, ".law-plot", name, table)
    page.locator(".law-legend li", has_text="onerror").wait_for()
    drop(visit, ".explorer", name.replace(".csv", ".png"), bytes([137, 80, 78, 71]))
    page.get_by_text("onerror").last.wait_for()
    text = Document(demo_text("operating-points")).with_values(
        {"target.kind": HTML, "sites.empty": [HTML], HTML.replace(".", "-"): {"a": 1}}
    )
    link = to_link(State(text + f"\n# {HTML}\n", {HTML: HTML}, table.decode(), HTML, False, (HTML,)))
    page.evaluate("link => { location.hash = link; }", link)
    page.locator(".chip", has_text="problems in the specification").wait_for()
    for tab in ("Specification", "How sure", "Take it", "Workshop"):
        page.get_by_role("tab", name=tab).click()
    visit.at_rest()
    assert page.evaluate("() => window.hacked") is None
    assert page.locator("img[src=x]").count() == 0
