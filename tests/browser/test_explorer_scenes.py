"""Unusual scenes in the browser: long histories, many sites, many points."""

import json
import re

import pytest

from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.link import to_link
from metafem.files import demo_text

pytestmark = pytest.mark.slow

TEXT = demo_text("operating-points")
# A browser that keeps a million and a half of characters.
SMALL = """() => {
  const set = Storage.prototype.setItem;
  Storage.prototype.setItem = function (key, text) {
    const others = Object.keys(this).filter(each => each !== key);
    const rest = others.reduce((sum, each) => sum + this[each].length, 0);
    if (rest + text.length > 1.5e6) throw new DOMException('full', 'QuotaExceededError');
    set.call(this, key, text);
  };
}"""

# A browser that keeps nothing of the page.
FULL = """() => {
  Storage.prototype.setItem = key => { if (key.startsWith('metafem')) throw Error('full'); };
}"""

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


def test_a_long_history_outlives_a_reload_without_its_oldest_states(visit):
    visit.page.evaluate(SMALL)
    table = "load_N,friction_force_N\n0.1,0.12\n" + "# remark\n" * 45_000
    for number in range(4):
        shown(visit, State(TEXT, {"large.csv": table}, measured=str(number)))
    visit.page.reload()  # NiceGUI drops a message of a megabyte
    visit.settled()
    history = visit.history
    numbers = [json.loads(each)["measured"] for each in history["states"]]
    assert numbers == ["1", "2", "3"]
    before = visit.asked
    visit.page.get_by_role("button", name="Undo").click()
    visit.settled(before)
    assert visit.history["at"] == history["at"] - 1


def test_a_state_that_the_browser_cannot_keep_is_told(visit):
    visit.page.evaluate(FULL)
    full = visit.page.locator(".lost").filter(has_text="cannot keep a state of")
    shown(visit, State(TEXT + "\n# longer\n"))
    assert not full.is_visible()  # the address keeps it
    visit.page.evaluate("""() => {
      const own = document.querySelector('[data-asked]');
      const kept = { first: 0, end: 1, at: 0, state: 'x'.repeat(6e6), link: '', asked: own.dataset.asked };
      getElement(Number(own.id.slice(1))).keep(kept);
    }""")
    assert "a state of 6.0 MB: a reload of the page loses it" in full.inner_text()


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


def test_a_single_row_has_a_bar_that_can_be_read(visit):
    row = {"lattice.shape": [1, 50], "block.width": "85 mm", "target.kind": "linear", "target.slope": 6.87}
    points = {"target.rescaled_load": None, "target.rescaled_friction": None}
    shown(visit, State(Document(TEXT).with_values({**row, **points})))
    bar = visit.page.locator(".surface-view .axes").nth(1)
    assert bar.bounding_box()["height"] > 150


def test_a_picture_of_many_sites_shows_those_around_the_middle(visit):
    found = visit.page.evaluate(
        """async () => {
          const { MOST_CAPS, nearest } = await import('metafem-surface/relief.js');
          const grid = Array.from({ length: 300 * 300 }, (_, i) => [i % 300, Math.floor(i / 300)]);
          const layout = { x: grid.map(each => each[0]), y: grid.map(each => each[1]) };
          const drawn = nearest(layout);
          const away = drawn.map(i => Math.max(Math.abs(layout.x[i] - 149.5), Math.abs(layout.y[i] - 149.5)));
          return [MOST_CAPS, drawn.length, new Set(drawn).size, Math.max(...away)];
        }"""
    )
    assert found[:3] == [found[0]] * 3
    assert found[3] <= found[0] ** 0.5 / 2 + 1


def test_a_large_table_is_thinned(visit):
    rows = "".join(f"{1e-5 * i:.6f},{1.4e-5 * i:.6f}\n" for i in range(1, 100_001))
    visit.page.evaluate(DROPPED, ["m.csv", f"# of a tribometer\nload_N,friction_force_N\n{rows}"])
    visit.page.locator(".law-live span", has_text="Of its 100,000 rows one in 50 is taken.").wait_for()
    assert "2000 points of m.csv" in visit.page.locator(".law-live span").inner_text()
    visit.at_rest()
    history = visit.history
    measured = json.loads(history["states"][history["at"]])["measured"].splitlines()
    assert measured[:3] == ["load_N,friction_force_N", "0.000010,0.000014", "0.000510,0.000714"]


def test_models_that_are_computed_stand_in_the_legend(visit):
    words = visit.page.evaluate(
        """async () => {
          const { entries } = await import('metafem-law/picture.js');
          return entries({ handles: [], crowd: '', pending: ['layer'] }).map(each => each[1]);
        }"""
    )
    assert words == ["layer: being computed …"]


def test_small_values_leave_a_power_of_ten_to_the_unit_of_their_bar(visit):
    texts = visit.page.evaluate(
        """async () => {
          const { drawBar } = await import('metafem-surface/frame.js');
          const { made } = await import('metafem-law/svg.js');
          const [parent, view] = [made('g'), { bar: { top: 0, bottom: 100 }, box: { right: 0 } }];
          const scale = { low: -0.0002, high: 0.0002, css: () => 'red' };
          drawBar(parent, view, { name: 'change', unit: '%', scale, present: [] });
          return [...parent.querySelectorAll('text')].map(each => each.textContent);
        }"""
    )
    assert texts == ["−2", "−1", "0", "1", "2", "change [10⁻⁴ %]"]


def test_a_place_that_only_the_whole_search_reaches_is_kept_on_release(visit):
    values = {
        "lattice.shape": [5, 5],
        "limits.offset": "100 um",
        "target.rescaled_load": ["0.681 mm^2", "0.752 mm^2", "0.867 mm^2"],
        "target.rescaled_friction": ["3.71 mm^2", "3.98 mm^2", "4.4 mm^2"],
    }
    state = State(Document(TEXT).with_values(values), newtons=False)  # its values have the digits of a pixel
    assert answered(state, 1, draft=True).undecided
    shown(visit, state)
    before = visit.asked
    visit.page.locator('.handle[data-id="point-2"]').focus()
    for key in ("ArrowUp", "ArrowDown"):
        visit.page.keyboard.press(key)
    visit.settled(before)
    assert "Refused" not in visit.page.locator(".law-live span").inner_text()
    assert visit.page.locator(".law-refusal").is_hidden()
    assert visit.text == state.text
