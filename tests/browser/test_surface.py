"""The surface in a browser: its map, its picture in three dimensions, and pressing it."""

import re

import pytest

from metafem.explorer.surface_data import asked_sites
from metafem.files import parsed, toml_table
from tests.browser import after, site
from validation.scenes.browser import browser_path
from validation.scenes.explorer import visited


def click(visit, number):
    visit.page.mouse.click(*site(visit, number))


def told(visit, number):
    """Return what the page tells of a site under the pointer."""
    visit.page.mouse.move(*site(visit, number))
    visit.page.locator(".tip", has_text=f"site {number + 1}").wait_for()
    return visit.page.locator(".tip").inner_text()


def menu(visit, action):
    return visit.page.locator(f'.menu [data-action="{action}"]')


def sites_after(visit, step):
    """Do a step and wait for its answer, and until the map has its place: other lines of text move it."""
    after(visit, step)
    visit.at_rest()
    return asked_sites(toml_table(visit.text))


def test_sites_are_kept_typed_left_empty_and_released(visit):
    click(visit, 20)
    shown = float(re.search(r"[\d.]+(?= µm)", menu(visit, "pin").inner_text())[0])
    assert sites_after(visit, menu(visit, "pin").click)[0] == {20: f"{shown} um"}
    assert ", kept" in told(visit, 20)
    click(visit, 9)
    visit.page.get_by_label("Height in micrometres").fill("120.5")
    sites_after(visit, menu(visit, "type").click)
    click(visit, 10)
    asked = sites_after(visit, menu(visit, "empty").click)
    assert asked == ({9: "120.5 um", 20: f"{shown} um"}, [10])
    assert "left empty" in told(visit, 10)
    design = parsed(visit.text, {}).design()
    heights = dict(zip(design.sites.tolist(), 1e3 * design.surface.height, strict=True))
    assert (heights[9], heights[20]) == pytest.approx((120.5, shown), rel=1e-12)
    assert 10 not in heights
    click(visit, 10)
    assert sites_after(visit, menu(visit, "release").click)[1] == []
    for _ in range(4):
        after(visit, visit.page.get_by_role("button", name="Undo").click)
    visit.at_rest()
    assert ", kept" not in told(visit, 20)
    mouse, ((left, low), (right, high)) = visit.page.mouse, [site(visit, number) for number in (8, 17)]
    mouse.move(left - 9, low + 9)
    mouse.down()
    mouse.move(right + 9, high - 9, steps=3)
    mouse.up()
    assert visit.page.locator(".menu b").inner_text() == "4 sites"
    visit.page.keyboard.down("Shift")
    for number in (18, 8):
        click(visit, number)
    visit.page.keyboard.up("Shift")
    assert sites_after(visit, menu(visit, "empty").click)[1] == [9, 16, 17, 18]


def test_the_map_fills_its_place_and_its_colours_say_what_they_mean(visit):
    page = visit.page
    block, place = (page.locator(f".surface-view {each}").bounding_box() for each in (".axes .frame", ".box"))
    assert max(block["width"] / place["width"], block["height"] / place["height"]) > 0.8
    for what, words in (("pressure", "mean contact pressure [MPa]"), ("sensitivity", "[%/µm]")):
        page.get_by_label("Colour of the sites").select_option(what)
        page.locator(".surface-view .colours", has_text=words).wait_for()
    assert "of friction per µm" in told(visit, 20)


@pytest.fixture
def pressed(visit):
    """The page, once the browser has the contacts at all loads."""
    visit.page.wait_for_function("() => document.querySelector('.rug').getAttribute('d')")
    visit.at_rest()
    return visit.page


# A browser without WebGL. Layout shifts from here on, and the frames in which the number of contacts changes.
WATCHED = """() => {
  const { getContext } = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
    return kind.startsWith('webgl') ? null : getContext.call(this, kind, ...more);
  };
  window.shifts = [];
  window.counts = new Set();
  const shift = list => shifts.push(...list.getEntries().map(each => each.value));
  new PerformanceObserver(shift).observe({ type: 'layout-shift' });
  const words = document.querySelector('.press span');
  const changed = new MutationObserver(() => counts.add(words.textContent));
  changed.observe(words, { subtree: true, characterData: true, childList: true });
}"""


def load(page):
    """Return the loads beside the slider and of the mark on the law [N]."""
    words = page.locator(".press span").inner_text()
    marked = page.evaluate("() => getElement(document.querySelector('.law-plot')).load")
    return float(re.search(r"([\d.]+) N", words)[1]), marked


def test_without_webgl_the_map_plays_from_the_smallest_to_the_largest_load_and_moves_nothing(visit, pressed):
    page = pressed
    page.evaluate(WATCHED)
    page.get_by_role("button", name="Press it").click()
    page.get_by_role("button", name="Pause").wait_for()
    page.wait_for_function("() => counts.size > 10")  # motion also on a busy machine
    page.get_by_label("Load", exact=True).fill("200")  # of 250: a hand at the slider ends the motion
    page.get_by_role("button", name="Press it").click()  # on from there
    page.get_by_role("button", name="Press it").wait_for()
    visit.at_rest()
    counts = page.evaluate("() => [...counts]")
    closed = [int(re.match(r"\d+", each)[0]) for each in counts]
    assert closed == sorted(closed)
    assert (closed[0], closed[-1]) == (5, 58)
    assert page.evaluate("() => shifts") == []
    assert load(page) == pytest.approx((0.971, 0.971), rel=1e-3)
    page.get_by_role("tab", name="3D").click()
    page.get_by_text("This browser has no WebGL").wait_for()
    visit.errors.clear()  # three.js reports what it could not make


def test_slider_and_law_carry_one_load_and_a_site_marks_its_tick(visit, pressed):
    page = pressed
    slider = page.get_by_label("Load", exact=True)
    slider.press("Home")
    visit.at_rest()
    beside, marked = load(page)
    assert marked == pytest.approx(beside, rel=0.01)
    assert page.locator(".press span").inner_text().startswith("5 of 58 in contact")
    for _ in range(50):
        slider.press("ArrowRight")
    visit.at_rest()
    # a step is 1/250 of the loads of the law, from 0.01 of the largest
    assert load(page)[1] == pytest.approx((0.01 + 0.99 * 50 / 250) * 0.971, rel=0.01)
    box = page.locator(".law-svg").bounding_box()
    page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + 0.6 * box["height"])
    visit.at_rest()
    beside, marked = load(page)
    assert beside == pytest.approx(marked, rel=0.005)
    assert int(slider.input_value()) > 200
    assert slider.get_attribute("aria-valuetext") == page.locator(".press span").inner_text()
    tip = told(visit, 20)
    page.locator(".law-readout", has_text="site 21 comes into contact at").wait_for()
    assert re.search(r"load [\d.]+ mN, [\d.]+ % of all", tip)
    entry = float(re.search(r"comes into contact at ([\d.]+) N", tip)[1])
    mark = page.locator(".rug-mark").bounding_box()
    page.mouse.move(mark["x"] + mark["width"] / 2, mark["y"] + 3)
    page.locator(".law-readout", has_text=f"sites come into contact at {entry:.3g}").wait_for()
    marks = page.evaluate("() => [...getElement(document.querySelector('.surface-view')).marks.pointed]")
    assert 20 in marks
    page.locator(".surface-view svg").focus()
    page.keyboard.press("ArrowUp")
    page.locator(".law-readout", has_text="site 9").wait_for()


# The picture in three dimensions.
RELIEF = "() => getElement(document.querySelector('.surface-view')).solid"


def test_the_picture_in_three_dimensions_has_every_cap_and_contact(browser, server):
    """By a browser whose processor draws what needs a graphics card."""
    options = ["--no-sandbox", "--enable-unsafe-swiftshader"]
    with (
        browser.browser_type.launch(executable_path=browser_path(), args=options) as software,
        visited(software, server, touch=True) as visit,
    ):
        page = visit.page
        if not page.evaluate("() => document.createElement('canvas').getContext('webgl2') !== null"):
            pytest.skip("this browser has no WebGL")
        page.get_by_role("tab", name="3D").click()
        page.wait_for_function(f"() => ({RELIEF})()?.sites?.length === 58")
        caps, frame = page.evaluate(
            f"() => [({RELIEF})().caps.map(each => each.count), ({RELIEF})().renderer.info.render.frame]"
        )
        assert caps == [58]
        assert frame > 0
        before = page.evaluate(f"() => ({RELIEF})().camera.position.toArray()")
        page.get_by_label("Surface in three dimensions").press("ArrowLeft")
        assert page.evaluate(f"() => ({RELIEF})().camera.position.toArray()") != before
        assert visit.errors == []
