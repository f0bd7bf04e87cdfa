"""Pages in a browser: reports, and of the explorer its start, messages, touch and wrong input."""

import re
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem.errors import Infeasible, InvalidInput
from metafem.explorer.history import State, to_link
from metafem.explorer.surface_data import asked_sites
from metafem.explorer.table import with_values, written
from metafem.files import demo_text, parsed, result_tables
from tests.browser import WHOLE, after, drop, hold, site
from validation.page import write_report
from validation.results import evaluated
from validation.scenes.browser import problems
from validation.scenes.explorer import SCRIPT, Visit, served, visited


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
    write_report(folder, {name: evaluated(name) for name in ("bounds", "table_s1")}, ["fe_hertz"])
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
def test_prints_show_what_is_folded(browser, validated):
    """The rows of a claim's checks stand in folded parts."""
    page = browser.new_page()
    try:
        page.goto((validated / "paper.html").as_uri())
        place = page.locator("main details tr").first
        assert not place.is_visible()
        page.emulate_media(media="print")
        assert place.is_visible()
    finally:
        page.close()


# Most requests of the first page up to its first law; NiceGUI makes twelve of them itself.
MOST_REQUESTS = 30


def test_the_page_shows_the_first_law_and_asks_no_other_machine(browser, server):
    with visited(browser, server) as visit:
        assert visit.asked == 1
        assert visit.errors == []
        assert len(visit.requests) <= MOST_REQUESTS
        assert [each for each in visit.requests if not each.startswith(server.origin)] == []
    assert server.said == ""


def test_a_page_that_is_loaded_again_keeps_its_history(visit):
    visit.drag("point-1", 12, -20)
    text = visit.text
    visit.entered("limits.max_height", "280 um")
    visit.page.reload()
    visit.settled()
    assert 'max_height = "280 um"' in visit.text
    after(visit, visit.page.get_by_role("button", name="Undo").click)
    assert visit.text == text
    after(visit, visit.page.get_by_role("button", name="Undo").click)
    assert visit.text == demo_text("operating-points")


def test_a_message_can_be_read_and_goes_with_the_next_success(visit):
    page = visit.page
    page.get_by_role("button", name="Menu").click()
    page.get_by_role("button", name="Dark").click()
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
    assert page.evaluate(WHOLE)
    after(visit, page.mouse.up)
    still("release")
    after(visit, page.get_by_label("Load", exact=True).press, "ArrowLeft")
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

def endless(self, *given, draft=False):
    while type(self.model).__name__ == "BoundaryElements" and not draft:
        with doing("a search without an end"):
            time.sleep(0.01)
    return design(self, *given, draft=draft)

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
        stop.click()
        again.wait_for()
        assert page.locator(".bar .chip").inner_text() == "stopped: change something, or compute again"
        assert len(visit.handles()) == 3
        assert page.locator("[data-key='limits.max_height']").input_value() == "270 um"
        again.click()
        stop.click()
        again.wait_for()
        after(visit, page.get_by_label("Model", exact=True).select_option, "independent")
        assert page.locator(".bar .chip").inner_text() == "exact"
        assert server.said == ""


def test_a_drawn_law_is_never_stuck(visit):
    page, said = visit.page, []
    curve = "() => getElement(document.querySelector('.law-plot'))"
    for share in (0.2, 0.35, 0.62, 0.75, 0.9):
        x, y = page.evaluate(
            f"""share => {{
              const {{ answer: {{ achieved }}, x, y, $refs }} = ({curve})();
              const box = $refs.svg.getBoundingClientRect();
              const i = Math.round(share * (achieved.x.length - 1));
              return [box.x + x.px(achieved.x[i]), box.y + y.px(achieved.y[i]) + 3];
            }}""",
            share,
        )
        count = len(visit.handles())
        page.mouse.dblclick(x, y)
        page.wait_for_function("count => document.querySelectorAll('.handle').length > count", arg=count)
        visit.at_rest()
        assert page.evaluate(f"() => ({curve})().answer.refusal") == ""
        said.append(page.locator(".law-live span").inner_text())
    assert len(visit.handles()) == 8
    assert sum("now a curve that is approximated" in words for words in said) == 1
    visit.entered("limits.max_height", "20 um")
    page.locator(".law-refusal span").first.wait_for()
    visit.drag("point-7", 2, -6)
    page.wait_for_function(f"() => ({curve})().answer.refusal === ''")


TABS = ("Specification", "How sure", "Take it", "Workshop")

# Smallest target of a finger, and of a handle of the law [px], as in WCAG 2.2, criteria 2.5.8 and 2.5.5.
SMALL, HANDLE = 24, 44

# What is smaller than a finger needs, the width of the page beyond the window, and what of a tab is cut off.
SHAPE = """least => {
  const controls = [...document.querySelectorAll('button, input, select, summary, a, [role=tab]')];
  const small = controls.filter(each => {
    const box = (each.closest('label') ?? each).getBoundingClientRect();
    return each.checkVisibility() && Math.min(box.width, box.height) < least;
  });
  const inspector = document.querySelector('.inspector'), end = inspector.getBoundingClientRect().bottom;
  const cut = each => each.checkVisibility() && each.getBoundingClientRect().bottom > end;
  const parts = [...inspector.querySelectorAll('.q-tab-panel *:not(.unseen, .cm-scroller, .cm-scroller *)')];
  return {
    small: small.map(each => each.outerHTML), wide: document.documentElement.scrollWidth - innerWidth,
    cut: parts.filter(cut).map(each => each.outerHTML),
  };
}"""


@pytest.fixture(
    scope="module",
    params=[pytest.param((768, 1024), marks=pytest.mark.nightly), (390, 844)],
    ids=["tablet", "phone"],
)
def tablet(browser, server, request):
    """A page of a tablet or a phone."""
    with visited(browser, server, *request.param, touch=True) as visit:
        visit.size_of_screen = request.param
        yield visit


@pytest.fixture
def hand(tablet):
    """The page as at the first visit."""
    tablet.anew(*tablet.size_of_screen)
    yield tablet
    assert tablet.errors == []


def target(visit):
    return parsed(visit.text).target


def test_points_are_moved_added_and_removed_and_sites_kept(hand):
    page = hand.page
    (x, y), plot = hand.middle("point-1"), page.locator(".law-svg").bounding_box()
    before, friction = hand.asked, target(hand).rescaled_friction[1]
    # beside the point, within the reach of a finger
    session = page.context.new_cdp_session(page)

    def touch(kind, *points):
        places = [{"x": x + right, "y": y + down} for right, down in points]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    for i, kind in enumerate(["touchStart", *["touchMove"] * 4]):
        touch(kind, (17 + i, 10 - 3 * i))
    touch("touchEnd")
    hand.settled(before)
    assert target(hand).rescaled_friction[1] > friction
    assert page.evaluate("() => scrollY") == 0
    after(hand, page.get_by_role("button", name="Remove the point").tap)
    assert len(hand.handles()) == 2
    moved = page.locator(".law-svg").bounding_box()  # the first hint has gone
    for _ in range(2):
        touch("touchStart", (moved["x"] - plot["x"], moved["y"] - plot["y"]))
        touch("touchEnd")
    page.wait_for_function("() => document.querySelectorAll('.handle').length === 3")
    page.touchscreen.tap(*site(hand, 20))
    after(hand, page.get_by_role("button", name="Keep this height").tap)
    assert [*asked_sites(State(hand.text).table)[0]] == [20]


def test_the_page_is_scrolled_and_enlarged_over_the_pictures(hand):
    page = hand.page
    session = page.context.new_cdp_session(page)
    for picture in (".law-svg", ".surface-view svg"):
        page.evaluate("() => scrollTo(0, 0)")
        box = page.locator(picture).bounding_box()
        x, y = box["x"] + 0.75 * box["width"], min(box["y"] + 0.9 * box["height"], 600)
        session.send("Input.synthesizeScrollGesture", {"x": x, "y": y, "yDistance": -200})
        assert page.evaluate("() => scrollY") > 100
        session.send("Input.synthesizePinchGesture", {"x": x, "y": y / 2, "scaleFactor": 2})
        assert page.evaluate("() => visualViewport.scale") > 1.5
        session.send("Emulation.setPageScaleFactor", {"pageScaleFactor": 1})


def test_nothing_is_too_small_or_cut_off(hand):
    page = hand.page
    page.emulate_media(reduced_motion="reduce")
    page.get_by_role("button", name="Menu").tap()
    page.get_by_role("button", name="Dark").tap()
    assert page.evaluate(SHAPE, SMALL) == {"small": [], "wide": 0, "cut": []}
    page.locator(".bar h1").tap()
    page.locator(".law-legend .tolerance").wait_for(state="attached")
    for tab in TABS:
        page.get_by_role("tab", name=tab).tap()
        page.wait_for_function("() => document.querySelectorAll('.q-tab-panel').length === 1")
        page.locator(
            {"Specification": ".cm-line", "How sure": ".sure-figures tr"}.get(tab, ".inspector")
        ).first.wait_for()
        assert page.evaluate(SHAPE, SMALL) == {"small": [], "wide": 0, "cut": []}, tab
        assert page.evaluate("() => document.getAnimations().length") == 0
    box = page.locator('.handle[data-id="point-0"] .touch').bounding_box()
    assert round(min(box["width"], box["height"])) >= HANDLE


# What runs if a page takes it for HTML.
HTML = "</script><img src=x onerror='window.hacked=1'><script>window.hacked=1</script>"


@pytest.mark.nightly
def test_no_text_is_taken_for_html(visit):
    page = visit.page
    visit.entered("lattice.pitch", HTML)
    page.locator(".chip", has_text="1 problem").wait_for()
    visit.entered("lattice.pitch", "1.5 mm")
    name = f"{HTML}.csv".replace("/", "")
    drop(visit, ".law-plot", name, b"a,b\n")
    page.locator(".q-notification", has_text="onerror").wait_for()
    table = b"load_N,friction_force_N\n0.1,0.12\n0.3,0.4\n"
    drop(visit, ".law-plot", name, table)
    page.locator(".law-legend li", has_text="onerror").wait_for()
    drop(visit, ".explorer", name.replace(".csv", ".png"), bytes([137, 80, 78, 71]))
    page.get_by_text("onerror").last.wait_for()
    wrong = {"target.kind": HTML, "sites.empty": [HTML], HTML.replace(".", "-"): {"a": 1}}
    text = written(with_values(State(demo_text("operating-points")).table, wrong))
    link = to_link(State(text + f"\n# {HTML}\n", {HTML: HTML}, table.decode(), HTML, False))
    page.evaluate("link => { location.hash = link; }", link)
    page.locator(".chip", has_text="problems in the specification").wait_for()
    for tab in ("Specification", "How sure", "Take it", "Workshop"):
        page.get_by_role("tab", name=tab).click()
    visit.at_rest()
    assert page.evaluate("() => window.hacked") is None
    assert page.locator("img[src=x]").count() == 0
    assert [each for each in visit.requests if not each.startswith(visit.server.origin)] == []


STEPS, BATCH = 400, 40

# Keys and texts of all fields, apart from the numbers of asperities, which set the time of a design.
FIELDS = """() => [...document.querySelectorAll('.fields input.text')]
  .filter(each => each.dataset.key !== 'lattice.shape').map(each => [each.dataset.key, each.value])"""

# Middles of all handles [pixels].
MIDDLES = """() => [...document.querySelectorAll('.handle .mark')].map(each => {
  const box = each.getBoundingClientRect();
  return [each.closest('.handle').dataset.id, box.x + box.width / 2, box.y + box.height / 2];
})"""

ARROWS = ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"]
KINDS = ["linear", "bilinear", "power", "multilinear", "sampled", "operating-points"]


class Hand:
    """Makes random steps with the mouse and the keyboard."""

    def __init__(self, visit, seed):
        self.visit, self.page, self.rng = visit, visit.page, np.random.default_rng(seed)

    def step(self):
        """Make a step."""
        steps = (self.drag, self.key, self.history, self.site, self.field, self.kind)
        steps[self.rng.choice(len(steps), p=(0.4, 0.23, 0.2, 0.08, 0.07, 0.02))]()

    def chosen(self):
        """Return a random handle with its middle, or None."""
        found = self.page.evaluate(MIDDLES)
        return found[self.rng.integers(len(found))] if found else None

    def drag(self):
        """Drag a handle, at times far out of what can be reached."""
        if (handle := self.chosen()) is None:
            return
        _, x, y = handle
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        for right, down in self.rng.uniform(-1.0, 1.0, (3, 2)) * self.rng.choice(
            [12.0, 200.0], p=[0.95, 0.05]
        ):
            self.page.mouse.move(x + right, y + down)
        self.page.mouse.up()

    def key(self):
        """Move a handle by the keyboard, add a point or remove one."""
        if (handle := self.chosen()) is not None:
            self.page.evaluate(f"""() => document.querySelector('.handle[data-id="{handle[0]}"]')?.focus()""")
            self.page.keyboard.press(self.rng.choice([*ARROWS, "Shift+ArrowUp", "a", "Delete"]))

    def history(self):
        """Undo or redo some steps."""
        self.page.locator(".bar h1").click()
        for _ in range(self.rng.integers(1, 4)):
            self.page.keyboard.press(self.rng.choice(["Control+z", "Control+z", "Control+y"]))

    def site(self):
        """Keep the height of a site, leave it empty, or let the design choose it."""
        self.page.locator(".surface-view svg").focus()
        for key in (*self.rng.choice(ARROWS, 2), self.rng.choice(["p", "e", "r"])):
            self.page.keyboard.press(key)

    def field(self):
        """Type a value into a field: a number near the present one, or at times what it cannot be."""
        fields = self.page.evaluate(FIELDS)
        key, text = fields[self.rng.integers(len(fields))]
        number = re.search(r"[\d.]+", text)
        if number is None or self.rng.random() < 0.2:
            text = str(self.rng.choice(["", "12", "abc", "-5 um", "1e400 mm", "]", '"']))
        else:
            text = text.replace(number[0], f"{float(number[0]) * self.rng.uniform(0.9, 1.1):.3g}", 1)
        self.page.evaluate("probe.typed", [key, text])

    def kind(self):
        """Choose another kind of target."""
        self.page.locator('select[data-key="target.kind"]').select_option(str(self.rng.choice(KINDS)))


def compared(visit):
    """Compare the tables of the page with those of its specification; return whether there are any."""
    visit.page.get_by_role("tab", name="Take it").click()
    refused = visit.page.evaluate("() => getElement(document.querySelector('.law-plot')).answer.refusal")
    try:
        specification = parsed(visit.text, {})
        tables = result_tables(specification.design(), specification.part)
    except (InvalidInput, Infeasible):
        assert refused
        return False
    assert not refused
    for name in ("heights.csv", "law.csv"):
        with visit.page.expect_download() as download:
            visit.page.locator(f'[data-take="{name}"]').click()
        assert Path(download.value.path()).read_bytes() == tables[name].encode()
    return True


@pytest.mark.nightly
def test_random_steps_fail_nowhere_and_end_at_the_design_of_the_specification(browser, tmp_path):
    # without a part: no block can be made of a summit that random steps lead to the base plane
    text = re.sub(r"\[(block|part)\].*?(?=\n\[|\Z)", "", demo_text("operating-points"), flags=re.DOTALL)
    (tmp_path / "points.toml").write_text(text, "utf-8")
    with served(tmp_path / "points.toml") as server, visited(browser, server) as visit:
        hand = Hand(visit, 0)
        for _ in range(STEPS // BATCH):
            visit.page.get_by_role("tab", name="Workshop").click()
            visit.page.locator(".fields input.text").first.wait_for()
            for _ in range(BATCH):
                hand.step()
            visit.at_rest()
            while not compared(visit):
                hand.history()
                visit.at_rest()
            assert visit.errors == []
            assert server.said == "", server.said
