"""The law in a browser: moved by mouse, keys and touch, refused, compared, and measured points dropped."""

import pytest

from metafem.explorer.answer import answered
from metafem.explorer.session import State

pytestmark = pytest.mark.slow

FORCES = "load_N,friction_force_N,friction_force_sd_N\n0.1,0.12,0.02\n0.3,0.4,0.02\n0.6,0.8,0.02\n"

# A file that is dropped onto the plot.
DROPPED = """([name, content]) => {
  const files = new DataTransfer();
  files.items.add(new File([new Uint8Array(content)], name));
  document.querySelector('.law-plot').dispatchEvent(
    new DragEvent('drop', { dataTransfer: files, bubbles: true, cancelable: true }));
}"""


# Moves a handle by pixels without waiting for any answer. Returns how far from the target's curve [px] the
# handles are then, whether the curve has moved, and whether no answer has come.
FOLLOWED = """([id, right, down]) => {
  const plot = getElement(document.querySelector('.law-plot')).plot;
  const path = () => document.querySelector('path.wanted').getAttribute('d');
  const lines = () => path().split('M').filter(Boolean).map(line => line.split('L'));
  const curve = () => lines().map(line => line.map(point => point.split(' ').map(Number)));
  const place = node => node.getAttribute('transform').match(/[\\d.-]+/g).map(Number);
  const nodes = () => [...document.querySelectorAll('.handle')].map(place);
  const apart = lines => ([x, y]) => Math.min(...lines.flatMap(line => line.slice(1).map(([x1, y1], i) => {
    const [x0, y0] = line[i];
    const [wide, tall] = [x1 - x0, y1 - y0];
    const share = ((x - x0) * wide + (y - y0) * tall) / (wide ** 2 + tall ** 2);
    const along = Math.min(1, Math.max(0, share));
    return Math.hypot(x - x0 - along * wide, y - y0 - along * tall);
  })));
  const node = document.querySelector(`.handle[data-id="${id}"]`);
  const before = path(), number = plot.data.number;
  const box = node.querySelector('.mark').getBoundingClientRect();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const event = (kind, at) => node.dispatchEvent(new PointerEvent(kind, {
    pointerId: 1, isPrimary: true, button: 0, buttons: 1, bubbles: true, clientX: at[0], clientY: at[1] }));
  plot.svg.setPointerCapture = () => {};
  event('pointerdown', [x, y]);
  event('pointermove', [x + right, y + down]);
  delete plot.svg.setPointerCapture;
  const found = [nodes().map(apart(curve())), path() !== before, plot.data.number === number];
  event('pointerup', [x + right, y + down]);
  return found;
}"""


# Names beside the curves that lie on each other, on a handle or beyond the plot.
COVERED = """() => {
  const box = each => each.getBoundingClientRect();
  const names = [...document.querySelectorAll('.law-svg .name')];
  const marks = [...document.querySelectorAll('.handle .mark, .carried')].filter(each => box(each).width);
  const over = (a, b) => a.left < b.right && b.left < a.right && a.top + 2 < b.bottom && b.top + 2 < a.bottom;
  const plot = box(document.querySelector('.law-svg'));
  return names.filter((each, i) => [...names.slice(0, i), ...marks].some(other => over(box(each), box(other)))
    || box(each).right > plot.right + 1).map(each => each.firstChild.data);
}"""

# The ends of both axes, and whether a zoom holds them.
AXES = """() => {
  const { x, y, zoomed } = getElement(document.querySelector('.law-plot')).plot.view;
  return [x.low, x.high, y.low, y.high, zoomed];
}"""


def target(visit):
    """Return the target of the text."""
    return answered(State(visit.text), 1).specification.target


def said(visit):
    """Return what stands below the plot."""
    return visit.page.locator(".law-live span").inner_text()


def test_a_dragged_point_changes_the_text_and_a_refused_one_returns(visit):
    visit.drag("point-1", 12, -20)
    moved = target(visit)
    assert moved.rescaled_friction[1] > 1.7
    before = visit.asked
    x, y = visit.middle("point-1")
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.move(x, y - 60, steps=4)
    visit.page.mouse.move(20.0, y - 160, steps=4)
    visit.page.locator(".handle.refused").wait_for()
    assert " N" in visit.page.locator(".law-refusal span").inner_text()
    assert visit.page.locator("path.achieved.old").count() == 1
    visit.page.mouse.up()
    visit.settled(before)
    visit.page.wait_for_function("() => document.querySelector('.law-refusal').hidden")
    assert said(visit).startswith("Refused. The point is back to")
    assert answered(State(visit.text), 1).current


def test_points_are_moved_added_and_removed_by_keys(visit):
    page = visit.page
    page.locator('.handle[data-id="point-1"]').focus()
    for keys, change in (("ArrowUp", 0.01), ("Shift+ArrowUp", 0.1)):
        before, friction = visit.asked, target(visit).rescaled_friction[1]
        page.keyboard.press(keys)
        visit.settled(before)
        assert target(visit).rescaled_friction[1] - friction == pytest.approx(change, rel=0.5)
        assert said(visit).startswith("point 2 of 3: load 0.457 N, friction ")
    before = visit.asked
    page.keyboard.press("a")
    visit.settled(before)
    assert len(visit.handles()) == 4
    page.locator('.handle[data-id="point-2"]').focus()
    before = visit.asked
    page.keyboard.press("Delete")
    visit.settled(before)
    assert len(visit.handles()) == 3
    assert page.evaluate("() => document.activeElement.classList.contains('handle')")
    page.locator(".load-knob").focus()
    before, text = visit.asked, visit.text
    page.keyboard.press("Shift+ArrowLeft")
    visit.settled(before)
    assert visit.text == text
    assert float(page.locator(".load-knob").get_attribute("aria-valuenow")) < 0.95


def test_the_nearest_law_is_taken_and_every_kind_can_be_dragged(visit):
    page = visit.page
    for kind in ("linear", "bilinear", "power", "multilinear", "sampled", "operating-points"):
        before = visit.asked
        page.locator('[data-key="target.kind"]').select_option(kind)
        visit.settled(before)
        visit.drag(visit.handles()[-1], 8, -6)
        answer = answered(State(visit.text), 1)
        assert answer.current, (kind, answer.refused)
    x, y = visit.middle("point-2")
    before = visit.asked
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, 100, steps=5)
    page.locator(".handle.refused").wait_for()
    page.mouse.up()
    visit.settled(before)
    kept, before = target(visit), visit.asked
    page.locator(".law-live .law-use").click()
    visit.settled(before)
    assert target(visit) != kept
    assert answered(State(visit.text), 1).current


def test_the_target_line_follows_the_hand_before_the_answer(visit):
    page = visit.page
    for kind, moves in (
        ("linear", {"slope-0": (0, -25)}),
        ("bilinear", {"slope-1": (0, -25)}),
        ("multilinear", {"slope-0": (0, -15), "crossover-0": (20, 0)}),
        ("sampled", {"point-3": (4, -15)}),
    ):
        before = visit.asked
        page.locator('[data-key="target.kind"]').select_option(kind)
        visit.settled(before)
        for id, by in moves.items():
            before = visit.asked
            apart, moved, alone = page.evaluate(FOLLOWED, [id, *by])
            assert moved, (kind, id)
            assert alone
            assert max(apart) < 1.0, (kind, id, apart)
            visit.settled(before)


def test_further_models_and_newtons_are_shown_beside_the_law(visit):
    page = visit.page
    page.locator(".law-beside").click()
    page.get_by_label("half-space", exact=True).check()
    page.locator(".law-models label", has_text="layer").click()
    page.locator("path.other").nth(1).wait_for(state="attached")
    legend = page.locator(".law-legend").inner_text()
    assert "half-space, differs by" in legend
    assert "layer, differs by" in legend
    page.get_by_role("button", name="Compute the block").click()
    page.get_by_role("button", name="Stop the block").or_(
        page.get_by_role("button", name="Hide the block")
    ).click()
    page.get_by_role("button", name="Compute the block").wait_for()
    assert "block" not in page.locator(".law-legend").inner_text()
    page.keyboard.press("Escape")
    text = visit.text
    page.get_by_role("button", name="mm²", exact=True).click()
    page.locator("text.title", has_text="friction F/(σB) [mm²]").wait_for(state="attached")
    assert visit.text == text
    before = visit.asked
    visit.drag("point-0", 5, -3)
    assert visit.asked > before
    assert "mm^2" in visit.text.split("[material]")[0].split("rescaled_load =")[1]


def test_measured_points_are_shown_used_and_removed(visit):
    page = visit.page
    before = visit.asked
    page.evaluate(DROPPED, ["m.csv", list(FORCES.encode())])
    visit.settled(before)
    assert page.locator(".measured g").count() == 3
    assert "m.csv: the achieved law differs by" in page.locator(".law-legend").inner_text()
    before = visit.asked
    page.get_by_role("button", name="Use as target").click()
    visit.settled(before)
    assert type(target(visit)).__name__ == "SampledLaw"
    before = visit.asked
    page.get_by_role("button", name="Remove", exact=True).first.click()
    visit.settled(before)
    assert page.locator(".measured g").count() == 0


def test_other_files_are_refused_and_change_nothing(visit):
    text = visit.text
    for content, words in (
        (b"\x89PNG\r\n\x1a\n\xff\xfe", "is not a text file"),
        (b"", "is empty"),
        (b"a,b\n1,2\n", "name its columns"),
        (b"load_N,friction_force_N\n0.1,nan\n", "is not a finite number"),
        (b"x" * 100_001, "100 kB"),
    ):
        visit.page.evaluate(DROPPED, ["m.csv", list(content)])
        visit.page.locator(".law-live.wrong span", has_text=words).wait_for()
        assert "m.csv" in said(visit)
    assert visit.text == text
    assert visit.page.locator(".measured g").count() == 0


def test_curves_carry_their_names_where_they_cover_nothing(visit):
    page, named = visit.page, visit.page.locator(".law-svg .name")
    before = visit.asked
    page.get_by_role("button", name="Pin as A").click()
    visit.settled(before)
    before = visit.asked
    page.evaluate(DROPPED, ["m.csv", list(FORCES.encode())])
    visit.settled(before)
    page.locator(".law-beside").click()
    for model in ("half-space", "layer"):
        page.get_by_label(model, exact=True).check()
    page.keyboard.press("Escape")
    for kind in ("linear", "power", "operating-points"):
        before = visit.asked
        page.locator('[data-key="target.kind"]').select_option(kind)
        visit.settled(before)
        page.locator(".name.other-1").wait_for()
        page.locator(".name.tolerance").wait_for()
        assert page.evaluate(COVERED) == [], kind
    words = {
        words.partition("\n")[0] for words in named.evaluate_all("all => all.map(e => e.firstChild.data)")
    }
    names = {"target", "achieved", "A", "possible", "made ± 1 SD", "half-space", "layer", "measured"}
    assert words == names
    assert "possible at one load" in page.locator(".law-legend").inner_text()  # for screen readers
    assert page.locator(".law-legend li", has_text="possible").bounding_box()["width"] <= 1
    page.set_viewport_size({"width": 390, "height": 844})
    page.wait_for_function("() => !document.querySelector('.law-svg .name')")
    assert page.locator(".law-legend li", has_text="possible").bounding_box()["width"] > 100


def test_the_axes_are_zoomed_and_fitted(visit):
    page = visit.page
    fitted = page.evaluate(AXES)
    assert (fitted[0], fitted[2], fitted[4]) == (0, 0, False)
    place = visit.middle("point-1")
    page.locator('.handle[data-id="point-1"]').focus()
    page.keyboard.press("+")
    page.keyboard.press("+")
    assert visit.middle("point-1") == pytest.approx(place, abs=1)  # around the handle in focus
    low, high, bottom, top, zoomed = near = page.evaluate(AXES)
    assert zoomed
    assert (high - low) / fitted[1] == pytest.approx(0.64)
    assert low > 0.0 < bottom
    visit.drag("point-1", 6, -8)
    before = visit.asked
    page.keyboard.press("ArrowUp")
    visit.settled(before)
    assert page.evaluate(AXES) == near  # in drags, too
    assert answered(State(visit.text), 1).current
    for _ in range(8):
        page.keyboard.press("+")
    bottom, top = page.evaluate(AXES)[2:4]
    before, friction = visit.asked, target(visit).rescaled_friction[1]
    page.keyboard.press("ArrowUp")
    visit.settled(before)
    step = (top - bottom) / 400 / (0.370 * 0.85)  # F = 0.370 MPa 0.85 A
    assert target(visit).rescaled_friction[1] - friction == pytest.approx(step, rel=0.2)
    assert step < 1e-3 * friction
    high, top = page.evaluate(AXES)[1::2]
    page.keyboard.press("Tab")  # to a point beyond the axes
    shown = page.evaluate(AXES)
    assert shown[1] > high
    assert shown[3] > top
    assert not page.locator(".handle:focus").evaluate("each => each.classList.contains('outside')")
    page.keyboard.press("0")
    assert page.evaluate(AXES)[0::2] == [0, 0, False]
    x, y = visit.middle("point-0")
    page.mouse.move(x, y)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -200)
    page.keyboard.up("Control")
    page.wait_for_function(f"() => ({AXES})()[4]")
    assert visit.middle("point-0") == pytest.approx((x, y), abs=1)
    page.get_by_role("button", name="Zoom out").click()
    page.get_by_role("button", name="Fit").click()
    assert page.evaluate(AXES)[4] is False
    page.get_by_role("button", name="Zoom in").click()
    page.get_by_role("button", name="mm²", exact=True).click()
    page.wait_for_function(f"() => !({AXES})()[4]")  # another unit


def test_a_missed_coefficient_names_the_largest_with_a_button(visit):
    before = visit.asked
    page = visit.page
    page.locator('[data-key="target.kind"]').select_option("linear")
    visit.settled(before)
    key = "target.friction_coefficient" if "friction_coefficient" in visit.text else "target.slope"
    visit.entered(key, "60")
    page.locator(".law-refusal span", has_text="The largest over the loads that are reached").wait_for()
    before = visit.asked
    page.locator(".law-refusal .law-use").click()
    visit.settled(before)
    assert page.locator(".law-refusal").is_hidden()
    assert answered(State(visit.text), 1).design.misfit < 0.1


def test_points_are_dragged_by_touch(visit):
    visit.anew(390, 844)
    x, y = visit.middle("point-1")
    session = visit.page.context.new_cdp_session(visit.page)
    before = visit.asked

    def touch(kind, *points):
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": list(points)})

    touch("touchStart", {"x": x, "y": y})
    for i in range(1, 6):
        touch("touchMove", {"x": x + i, "y": y - 2 * i})
    touch("touchEnd")
    visit.settled(before)
    assert target(visit).rescaled_friction[1] > 1.68
    width = visit.page.evaluate("() => document.documentElement.scrollWidth")
    assert width <= 390
