"""What makes the page comfortable: it says what cannot be taken, keeps places, and begins anew."""

from metafem.files import demo_text


def begun(visit, name):
    """Start over from an example, and wait for its answer."""
    before = visit.asked
    visit.page.get_by_role("button", name="Menu").click()
    visit.page.get_by_role("menuitem", name=name).click()
    visit.settled(before)


def test_starting_over_is_one_step_that_undo_takes_back(visit):
    visit.drag(visit.handles()[0], 10, -10)
    mine = visit.text
    begun(visit, "bilinear")
    assert visit.text == demo_text("bilinear")
    begun(visit, "as first opened")
    assert visit.text == demo_text("operating-points")
    for _ in range(2):
        before = visit.asked
        visit.page.get_by_role("button", name="Undo").click()
        visit.settled(before)
    assert visit.text == mine


# Middles of the points that the box with the reason of a refusal covers.
COVERED = """() => {
  const box = document.querySelector('.law-refusal').getBoundingClientRect();
  return [...document.querySelectorAll('.handle .mark')].filter(mark => {
    const { x, y, width, height } = mark.getBoundingClientRect();
    const [right, down] = [x + width / 2, y + height / 2];
    return right > box.left && right < box.right && down > box.top && down < box.bottom;
  }).length;
}"""


def test_the_reason_of_a_refusal_covers_no_point_and_can_be_put_away(visit):
    page = visit.page
    visit.entered("limits.max_height", "20 um")
    for width in (1440, 390):
        page.set_viewport_size({"width": width, "height": 900})
        page.locator(".law-refusal span").wait_for()
        page.wait_for_function(f"() => ({COVERED})() === 0")
        page.get_by_label("Put the reason away").click()
        page.locator(".law-refusal span").wait_for(state="hidden")
        page.get_by_label("Show the reason of the refusal").click()
        page.locator(".law-refusal span").wait_for()
