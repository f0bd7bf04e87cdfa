"""What makes the page comfortable: it says what cannot be taken, keeps places, and begins anew."""

from metafem.files import demo_text
from tests.browser.hands import after


def begun(visit, name):
    """Start over from an example, and wait for its answer."""
    visit.page.get_by_role("button", name="Menu").click()
    after(visit, visit.page.get_by_role("menuitem", name=name).click)


def test_starting_over_is_one_step_that_undo_takes_back(visit):
    visit.drag(visit.handles()[0], 10, -10)
    mine = visit.text
    begun(visit, "bilinear")
    assert visit.text == demo_text("bilinear")
    begun(visit, "as first opened")
    assert visit.text == demo_text("operating-points")
    for _ in range(2):
        after(visit, visit.page.get_by_role("button", name="Undo").click)
    assert visit.text == mine
