"""The surface in three dimensions and its mould, in a browser with WebGL."""

import pytest

from validation.scenes.browser import browser_path
from validation.scenes.explorer import visited

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
def visit(software, server):
    with visited(software, server, touch=True) as visit:
        if not visit.page.evaluate("() => document.createElement('canvas').getContext('webgl2') !== null"):
            pytest.skip("this browser has no WebGL")
        yield visit
        assert visit.errors == []


@pytest.fixture
def page(visit):
    """The page, once the browser has the contacts at all loads."""
    visit.anew()
    visit.page.wait_for_function("() => document.querySelector('.rug').getAttribute('d')")
    visit.at_rest()
    return visit.page


@pytest.fixture
def relief(page):
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
