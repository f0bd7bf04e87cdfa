"""Unusual scenes in the browser: long histories, many sites, many points."""

import json
import re

import pytest

from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.link import to_link
from metafem.files import demo_text

pytestmark = pytest.mark.nightly

TEXT = demo_text("operating-points")


# Drops a file onto the law.
DROPPED = """([name, text]) => {
  const files = new DataTransfer();
  files.items.add(new File([text], name));
  document.querySelector('.law-plot').dispatchEvent(
    new DragEvent('drop', { dataTransfer: files, bubbles: true, cancelable: true }));
}"""


def shown(visit, state):
    """Open a state by its link and wait for its answer."""
    before = visit.asked
    visit.page.evaluate("link => { location.hash = link; }", to_link(state))
    visit.settled(before)


def test_several_radii_are_shown_as_colours_and_in_words(visit):
    select = visit.page.get_by_label("Colour of the sites")
    assert "radius" not in select.inner_text()
    several = {"lattice.radius": None, "tools.radii": ["200 um", "800 um"], "tools.mixed": True}
    several |= {"target.rescaled_load": None, "target.rescaled_friction": None, "target.kind": "power"}
    several |= {"target.exponent": 0.645, "target.load_range": ["0.1 mm^2", "0.3 mm^2"], "block": None}
    several |= {"limits.max_height": "120 um", "part": None}
    shown(visit, State(Document(TEXT).with_values(several)))
    select.select_option("radius")
    visit.page.locator(".surface-view .axes text").filter(has_text="radius of curvature [µm]").wait_for()
    visit.page.locator(".site:not(.empty)").first.hover()
    assert re.search(r"radius of curvature [28]00 µm", visit.page.locator(".tip").inner_text())
    shown(visit, State(TEXT))
    visit.page.locator(".surface-view .axes text").filter(has_text="height [µm]").wait_for()
    assert select.input_value() == "height"


def test_a_large_table_is_thinned(visit):
    rows = "".join(f"{1e-5 * i:.6f},{1.4e-5 * i:.6f}\n" for i in range(1, 100_001))
    visit.page.evaluate(DROPPED, ["m.csv", f"# of a tribometer\nload_N,friction_force_N\n{rows}"])
    visit.page.locator(".law-live span", has_text="Of its 100,000 rows one in 50 is taken.").wait_for()
    assert "2000 points of m.csv" in visit.page.locator(".law-live span").inner_text()
    visit.at_rest()
    history = visit.history
    measured = json.loads(history["states"][history["at"]])["measured"].splitlines()
    assert measured[:3] == ["load_N,friction_force_N", "0.000010,0.000014", "0.000510,0.000714"]
