"""The explorer on a tablet and on a phone: by fingers alone, with nothing too small or cut off."""

import pytest

from metafem.explorer.surface_data import asked_sites
from metafem.files import parsed
from tests.browser.hands import after
from validation.scenes.explorer import visited

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
    page.locator('[data-site="20"]').tap()
    after(hand, page.get_by_role("button", name="Keep this height").tap)
    assert set(asked_sites(hand.text).pinned) == {20}


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
    page.get_by_role("menuitemradio", name="Dark").tap()
    assert page.evaluate(SHAPE, SMALL) == {"small": [], "wide": 0, "cut": []}
    page.locator(".bar h1").tap()
    page.get_by_role("menu").wait_for(state="hidden")
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
