"""Pressing the surface in a browser: by play, slider and triangle, and the sites linked with the law."""

import re

import pytest

# Layout shifts from here on, and the frames in which the number of contacts changes.
WATCHED = """() => {
  HTMLCanvasElement.prototype.getContext = () => null;
  window.shifts = [];
  window.counts = new Set();
  const shift = list => shifts.push(...list.getEntries().map(each => each.value));
  new PerformanceObserver(shift).observe({ type: 'layout-shift' });
  const words = document.querySelector('.press span');
  const changed = new MutationObserver(() => counts.add(words.textContent));
  changed.observe(words, { subtree: true, characterData: true, childList: true });
}"""


@pytest.fixture
def pressed(visit):
    """The page, once the browser has the contacts at all loads."""
    visit.page.wait_for_function("() => document.querySelector('.rug').getAttribute('d')")
    visit.at_rest()
    return visit.page


def load(page):
    """Return the loads beside the slider and of the triangle of the law [N]."""
    words = page.locator(".press span").inner_text()
    return float(re.search(r"([\d.]+) N", words)[1]), triangle(page)


def triangle(page):
    return float(page.locator(".load-knob").get_attribute("aria-valuenow"))


def test_play_presses_from_the_smallest_to_the_largest_load_and_moves_nothing(visit, pressed):
    page = pressed
    page.evaluate(WATCHED)  # without WebGL the map plays
    page.get_by_role("button", name="Press it").click()
    page.get_by_role("button", name="Pause").wait_for()
    page.get_by_role("button", name="Press it").wait_for()
    visit.at_rest()
    counts = page.evaluate("() => [...counts]")
    closed = [int(re.match(r"\d+", each)[0]) for each in counts]
    assert closed == sorted(closed)
    assert (closed[0], closed[-1]) == (5, 58)
    assert len(counts) > 10  # motion also on a busy machine
    assert page.evaluate("() => shifts") == []
    assert load(page) == pytest.approx((0.971, 0.971), rel=1e-3)
    visit.errors.clear()  # three.js reports what it could not make


def test_slider_and_triangle_carry_one_load(visit, pressed):
    page = pressed
    slider = page.get_by_label("Load", exact=True)
    slider.focus()
    page.keyboard.press("Home")
    visit.at_rest()
    beside, marked = load(page)
    assert marked == pytest.approx(beside, rel=0.01)
    assert page.locator(".press span").inner_text().startswith("5 of 58 in contact")
    for _ in range(50):
        page.keyboard.press("ArrowRight")
    visit.at_rest()
    # a step is 1/250 of the loads of the law, from 0.01 of the largest
    assert triangle(page) == pytest.approx((0.01 + 0.99 * 50 / 250) * 0.971, rel=0.01)
    page.locator(".load-knob").focus()
    page.keyboard.press("Shift+ArrowRight")
    visit.at_rest()
    beside, marked = load(page)
    assert beside == pytest.approx(marked, rel=0.005)
    assert int(slider.input_value()) > 50
    assert slider.get_attribute("aria-valuetext") == page.locator(".press span").inner_text()


def test_a_site_marks_its_tick_and_a_tick_its_sites(visit, pressed):
    page = pressed
    page.locator('[data-site="20"]').hover()
    page.locator(".law-readout", has_text="site 20 comes into contact at").wait_for()
    tip = page.locator(".tip").inner_text()
    assert re.search(r"load [\d.]+ mN, [\d.]+ % of all", tip)
    assert "% of the contact area" in tip
    entry = float(re.search(r"comes into contact at ([\d.]+) N", tip)[1])
    mark = page.locator(".rug-mark").bounding_box()
    page.mouse.move(mark["x"] + mark["width"] / 2, mark["y"] + 3)
    page.locator(".law-readout", has_text=f"sites come into contact at {entry:.3g}").wait_for()
    assert "active" in page.locator('[data-site="20"]').get_attribute("class")
    page.locator(".surface-view svg").focus()
    page.keyboard.press("ArrowUp")
    page.locator(".law-readout", has_text="site 8").wait_for()
