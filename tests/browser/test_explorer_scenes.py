"""Unusual scenes in the browser: long histories, many sites, many points."""

import json

import pytest

from metafem.explorer.session import State
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
    visit.page.evaluate("() => { Storage.prototype.setItem = () => { throw new Error('full'); }; }")
    full = visit.page.locator(".lost").filter(has_text="cannot keep a state of")
    shown(visit, State(TEXT + "\n# longer\n"))
    assert not full.is_visible()  # the address keeps it
    visit.page.evaluate("""() => {
      const own = document.querySelector('[data-asked]');
      const kept = { first: 0, end: 1, at: 0, state: 'x'.repeat(6e6), link: '', asked: own.dataset.asked };
      getElement(Number(own.id.slice(1))).keep(kept);
    }""")
    assert "a state of 6.0 MB: a reload of the page loses it" in full.inner_text()
