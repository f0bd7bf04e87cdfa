"""The law in a browser: moved by mouse, keys and touch, refused, compared, and measured points dropped."""

import pytest

from metafem.explorer.answer import answered
from metafem.explorer.history import State
from tests.browser.hands import after, drop, hold

FORCES = "load_N,friction_force_N\n0.1,0.12\n0.3,0.4\n0.6,0.8\n"

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
    x, y = hold(visit, "point-1")
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


def test_the_nearest_law_is_taken_and_every_kind_can_be_dragged(visit):
    page = visit.page
    for kind in ("linear", "bilinear", "power", "multilinear", "sampled", "operating-points"):
        after(visit, page.locator('[data-key="target.kind"]').select_option, kind)
        visit.drag(visit.handles()[-1], 8, -6)
        answer = answered(State(visit.text), 1)
        assert answer.current, (kind, answer.refused)
    before = visit.asked
    x, _ = hold(visit, "point-2")
    page.mouse.move(x, 100, steps=5)
    page.locator(".handle.refused").wait_for()
    page.mouse.up()
    visit.settled(before)
    kept = target(visit)
    after(visit, page.locator(".law-live .law-use").click)
    assert target(visit) != kept
    assert answered(State(visit.text), 1).current


def test_further_models_and_newtons_are_shown_beside_the_law(visit):
    page = visit.page
    page.locator(".law-beside").click()
    page.get_by_label("half-space", exact=True).check()
    page.locator(".law-models label", has_text="layer").click()
    page.locator("path.other").nth(1).wait_for(state="attached")
    legend = page.locator(".law-legend").inner_text()
    assert "half-space, differs by" in legend
    assert "layer, differs by" in legend
    page.keyboard.press("Escape")
    text = visit.text
    page.get_by_role("button", name="mm²", exact=True).click()
    page.locator("text.title", has_text="friction F/(σB) [mm²]").wait_for(state="attached")
    assert visit.text == text
    before = visit.asked
    visit.drag("point-0", 5, -3)
    assert visit.asked > before
    assert "mm^2" in visit.text.split("[material]")[0].split("rescaled_load =")[1]


def test_measured_points_are_shown_and_removed(visit):
    page = visit.page
    after(visit, drop, visit, ".law-plot", "m.csv", FORCES.encode())
    assert page.locator(".measured rect").count() == 3
    assert "m.csv: 3 points" in page.locator(".law-legend").inner_text()
    after(visit, page.get_by_role("button", name="Remove", exact=True).first.click)
    assert page.locator(".measured rect").count() == 0


def test_the_axes_are_zoomed_and_fitted(visit):
    page = visit.page
    fitted = page.evaluate(AXES)
    assert (fitted[0], fitted[2], fitted[4]) == (0, 0, False)
    place = visit.middle("point-1")
    page.locator('.handle[data-id="point-1"]').focus()
    page.keyboard.press("+")
    page.keyboard.press("+")
    assert visit.middle("point-1") == pytest.approx(place, abs=1)  # around the handle in focus
    low, high, bottom, _, zoomed = near = page.evaluate(AXES)
    assert zoomed
    assert (high - low) / fitted[1] == pytest.approx(0.64)
    assert low > 0.0 < bottom
    visit.drag("point-1", 6, -8)
    after(visit, page.keyboard.press, "ArrowUp")
    assert page.evaluate(AXES) == near  # in drags, too
    assert answered(State(visit.text), 1).current
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
