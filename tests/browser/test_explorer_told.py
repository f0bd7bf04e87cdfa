"""Messages of the page: in its own words, readable, and gone when they are settled."""

from contextlib import closing

import pytest

from metafem.files import demo_text
from tests.browser.hands import after, hold
from validation.scenes.explorer import SCRIPT, Visit, served


def test_a_message_can_be_read_and_goes_with_the_next_success(visit):
    page = visit.page
    page.get_by_role("button", name="Menu").click()
    page.get_by_role("menuitemradio", name="Dark").click()
    page.keyboard.press("Escape")
    page.evaluate("() => { location.hash = 'm1.damaged'; }")
    message = page.locator(".q-notification")
    message.wait_for()
    visit.at_rest()  # the answer that shows the state once more leaves the message
    assert "leave" not in message.evaluate("node => node.className")
    visit.entered("limits.max_height", "271 um")
    message.wait_for(state="detached")


# Two frames: what has moved is known then.
FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"

# Collects the shifts of the layout, each with its value and the elements that moved.
SHIFTS = """() => {
  window.shifts = [];
  const name = node => (node?.nodeType === 3 ? node.parentElement : node);
  new PerformanceObserver(list => {
    for (const entry of list.getEntries()) {
      const moved = entry.sources.map(({ node, previousRect: a, currentRect: b }) =>
        `${name(node)?.outerHTML.slice(0, 80)}: ${a.x},${a.y} to ${b.x},${b.y}`);
      shifts.push([entry.value, ...moved]);
    }
  }).observe({ type: 'layout-shift' });
}"""


@pytest.mark.parametrize(
    "width", [1400, *(pytest.param(width, marks=pytest.mark.nightly) for width in (1000, 390))]
)
def test_nothing_moves_under_the_hand(visit, width):
    page = visit.page
    visit.anew(width, 900)
    page.locator("[data-beside]").wait_for()
    page.evaluate(SHIFTS)
    done = []

    def still(what):
        page.evaluate(FRAMES)
        done.append(what)
        assert page.evaluate("() => shifts") == [], what

    x, y = hold(visit, "point-1")
    page.mouse.move(x + 10, y - 10, steps=3)
    still("drag")
    page.mouse.move(x, y - 0.2 * page.locator(".law-svg").bounding_box()["height"], steps=4)
    page.locator(".handle.refused").wait_for()
    still("refusal under the hand")
    after(visit, page.mouse.up)
    still("release")
    page.evaluate("() => document.querySelector('.load-knob').focus({ preventScroll: true })")
    after(visit, page.keyboard.press, "Shift+ArrowLeft")
    still("load")
    for model in ("layer", "independent"):
        after(visit, page.get_by_label("Model", exact=True).select_option, model)
        still(model)
    after(visit, page.evaluate, "probe.typed", ["limits.max_height", "20 um"])
    page.locator(".law-refusal span").first.wait_for()
    still("refused state")


# An explorer in which resolved contacts are computed until the computation is stopped.
ENDLESS = """
import time
from metafem.cli import main
from metafem.files import Specification
from metafem.progress import doing

def endless(self, model=None, *, draft=False):
    while type(self.model).__name__ == "BoundaryElements" and not draft:
        with doing("a search without an end"):
            time.sleep(0.01)
    return design(self, model, draft=draft)

design, Specification.design = Specification.design, endless
main()
"""


def test_the_first_computation_of_a_page_can_be_stopped(browser, tmp_path):
    spec, program = tmp_path / "spec.toml", tmp_path / "endless.py"
    spec.write_text(demo_text("operating-points").replace('"independent"', '"resolved"'), "utf-8")
    program.write_text(ENDLESS, "utf-8")
    with served(spec, program=("-u", str(program))) as server, closing(browser.new_context()) as context:
        context.add_init_script(path=SCRIPT)
        page = context.new_page()
        visit = Visit(page, server)
        page.goto(server.address)
        stop, again = (page.get_by_role("button", name=name) for name in ("Stop", "Compute again"))
        for _ in range(2):
            stop.click()
            again.wait_for()
            assert page.locator(".bar .chip").inner_text() == "stopped: change something, or compute again"
            assert len(visit.handles()) == 3
            assert page.locator("[data-key='limits.max_height']").input_value() == "270 um"
            again.click()
        stop.click()
        again.wait_for()
        after(visit, page.get_by_label("Model", exact=True).select_option, "independent")
        assert page.locator(".bar .chip").inner_text() == "meets the target exactly"
        assert server.said == ""


def test_a_drawn_law_is_never_stuck(visit):
    page, said = visit.page, []
    curve = "() => getElement(document.querySelector('.law-plot')).plot"
    for share in (0.2, 0.35, 0.62, 0.75, 0.9):
        x, y = page.evaluate(
            f"""share => {{
              const {{ data, view, svg }} = ({curve})(), i = Math.round(share * (data.achieved.x.length - 1));
              const box = svg.getBoundingClientRect();
              return [box.x + view.px(data.achieved.x[i]), box.y + view.py(data.achieved.y[i]) + 3];
            }}""",
            share,
        )
        count = len(visit.handles())
        page.mouse.dblclick(x, y)
        page.wait_for_function("count => document.querySelectorAll('.handle').length > count", arg=count)
        visit.at_rest()
        assert page.evaluate(f"() => ({curve})().data.refusal") == ""
        said.append(page.locator(".law-live span").inner_text())
    assert len(visit.handles()) == 8
    assert sum("now a curve that is approximated" in words for words in said) == 1
    visit.entered("limits.max_height", "20 um")
    page.locator(".law-refusal span").first.wait_for()
    visit.drag("point-7", 2, -6)
    page.wait_for_function(f"() => ({curve})().data.refusal === ''")
