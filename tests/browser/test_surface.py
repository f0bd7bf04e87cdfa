"""The surface in a browser: its map, its picture in three dimensions, and pressing it."""

import re

import pytest

from metafem.explorer.surface_data import asked_sites
from metafem.files import parsed, toml_table
from tests.browser import after
from validation.scenes.browser import browser_path
from validation.scenes.explorer import visited


def site(visit, number):
    return visit.page.locator(f'[data-site="{number}"]')


def menu(visit, action):
    return visit.page.locator(f'.menu [data-action="{action}"]')


def sites_after(visit, step):
    """Do a step and wait for its answer, and until the map has its place: other lines of text move it."""
    after(visit, step)
    visit.at_rest()
    return asked_sites(toml_table(visit.text))


def heights(visit):
    """Return heights [um] by site of the design of the text that is shown, as the command finds them."""
    design = parsed(visit.text, {}).design()
    return dict(zip(design.sites.tolist(), 1e3 * design.surface.height, strict=True))


def test_a_height_is_kept_by_a_click_and_released_by_undo(visit):
    site(visit, 20).click()
    shown = float(re.search(r"[\d.]+(?= µm)", menu(visit, "pin").inner_text())[0])
    asked = sites_after(visit, menu(visit, "pin").click)
    assert asked.pinned == {20: f"{shown} um"}
    assert heights(visit)[20] == pytest.approx(shown, rel=1e-12)
    assert "pinned" in site(visit, 20).get_attribute("class")
    assert sites_after(visit, visit.page.get_by_role("button", name="Undo").click).pinned == {}
    assert "pinned" not in site(visit, 20).get_attribute("class")


def test_a_typed_height_and_an_empty_site(visit):
    site(visit, 9).click()
    visit.page.get_by_label("Height in micrometres").fill("120.5")
    assert sites_after(visit, menu(visit, "type").click).pinned == {9: "120.5 um"}
    site(visit, 10).click()
    assert sites_after(visit, menu(visit, "empty").click).empty == {10}
    assert "empty" in site(visit, 10).get_attribute("class").split()
    found = heights(visit)
    assert 10 not in found
    assert found[9] == pytest.approx(120.5, rel=1e-12)
    site(visit, 10).click()
    assert sites_after(visit, menu(visit, "release").click).empty == set()


def test_a_rectangle_and_further_clicks_select_several(visit):
    first, last = (site(visit, number).bounding_box() for number in (8, 17))
    mouse = visit.page.mouse
    mouse.move(first["x"] - 1, first["y"] + first["height"] + 1)
    mouse.down()
    mouse.move(last["x"] + last["width"], last["y"], steps=3)
    mouse.up()
    assert visit.page.locator(".menu b").inner_text() == "4 sites"
    site(visit, 18).click(modifiers=["Shift"])
    site(visit, 8).click(modifiers=["Shift"])
    assert sites_after(visit, menu(visit, "empty").click).empty == {9, 16, 17, 18}


def test_the_colours_say_what_they_mean(visit):
    for what, words in (("pressure", "mean contact pressure [MPa]"), ("sensitivity", "[%/µm]")):
        visit.page.get_by_label("Colour of the sites").select_option(what)
        visit.page.locator(".surface-view .axes text").filter(has_text=words).wait_for()
    site(visit, 20).hover()
    assert "of friction per µm" in visit.page.locator(".tip").inner_text()


def test_without_webgl_the_map_stays(visit):
    # the browser of the tests has neither a graphics card nor one in software
    visit.page.evaluate("() => { HTMLCanvasElement.prototype.getContext = () => null; }")
    visit.page.get_by_role("tab", name="3D").click()
    visit.page.get_by_text("This browser has no WebGL").wait_for()
    visit.errors.clear()  # three.js reports what it could not make
    visit.page.get_by_role("tab", name="Map").click()
    assert site(visit, 20).is_visible()


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


# The picture in three dimensions, once it shows the surface; and where the top of a site, or its hole, is on
# the screen.
RELIEF = """() => {
  const view = document.querySelector('.surface-view');
  return getElement(Number(view.id.slice(1))).pictures.relief;
}"""
PLACE = f"""([site, mould]) => {{
  const relief = ({RELIEF})(), {{ layout, surface, look }} = relief.newest;
  const glass = relief.glass.position.z;
  const at = mould ? [-layout.x[site], layout.y[site], 0]
    : [layout.x[site], layout.y[site], Math.min(look.times * surface.height[site] / 1e3, glass)];
  const {{ x, y }} = new relief.THREE.Vector3(...at).project(relief.camera);
  const box = relief.renderer.domElement.getBoundingClientRect();
  return [box.left + box.width * (1 + x) / 2, box.top + box.height * (1 - y) / 2];
}}"""


FRAMES = f"""async () => {{
  const frame = () => new Promise(requestAnimationFrame);
  const count = () => ({RELIEF})().renderer.info.render.frame;
  await frame(); await frame();
  const before = count();
  for (let i = 0; i < 10; i++) await frame();
  return count() - before;
}}"""


@pytest.fixture(scope="module")
def software(browser):
    """A browser whose processor draws what needs a graphics card."""
    options = ["--no-sandbox", "--enable-unsafe-swiftshader"]
    started = browser.browser_type.launch(executable_path=browser_path(), args=options)
    yield started
    started.close()


@pytest.fixture(scope="module")
def solid(software, server):
    with visited(software, server, touch=True) as visit:
        if not visit.page.evaluate("() => document.createElement('canvas').getContext('webgl2') !== null"):
            pytest.skip("this browser has no WebGL")
        yield visit
        assert visit.errors == []


@pytest.fixture
def relief(solid):
    """The picture in three dimensions, once the browser has the contacts at all loads."""
    page = solid.page
    solid.anew()
    page.wait_for_function("() => document.querySelector('.rug').getAttribute('d')")
    solid.at_rest()
    page.get_by_role("tab", name="3D").click()
    page.wait_for_function(f"() => ({RELIEF})()?.sites?.length")
    return page


def hovered(page, site, mould=False):
    page.wait_for_function(f"async () => await ({FRAMES})() === 0")  # the picture is at rest
    page.mouse.move(*page.evaluate(PLACE, [site, mould]))


def test_a_cap_marks_its_entry_load_and_a_tick_its_caps(relief):
    hovered(relief, 20)
    relief.locator(".tip", has_text="site 20").wait_for()
    relief.locator(".law-readout", has_text="site 20 comes into contact at").wait_for()
    assert relief.evaluate(f"() => ({RELIEF})().rings.count") == 1
    mark = relief.locator(".rug-mark").bounding_box()
    relief.mouse.move(mark["x"] + mark["width"] / 2, mark["y"] + 3)
    relief.wait_for_function(f"() => ({RELIEF})().rings.count > 1")
    assert relief.locator(".tip").count() == 0
    assert relief.evaluate(FRAMES) == 0


def test_the_mould_has_the_holes_of_the_sites(relief):
    relief.get_by_role("button", name="Mould").click()
    relief.wait_for_function(f"() => ({RELIEF})().mould")
    assert relief.evaluate(f"() => ({RELIEF})().sites.filter(each => each === null).length") == 4
    hovered(relief, 27, mould=True)
    tip = relief.locator(".tip", has_text="site 27")
    tip.wait_for()
    assert "hole 270.0 µm deep" in tip.inner_text()
    relief.get_by_role("button", name="Press it").click()  # what is pressed is the part
    relief.wait_for_function(f"() => !({RELIEF})().mould")
