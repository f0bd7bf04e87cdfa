"""What makes the page comfortable: it says what cannot be taken, keeps places, and begins anew."""

import pytest

from metafem.files import demo_text

pytestmark = pytest.mark.slow

# A curve whose surface has summits in the base plane.
NO_PART = """kind = "sampled"
load = ["0.1 N", "0.2 N", "0.3 N", "0.4 N"]
friction_force = ["0.1 N", "0.19 N", "0.28 N", "0.44 N"]
"""


def begun(visit, name):
    """Start over from an example, and wait for its answer."""
    before = visit.asked
    visit.page.get_by_role("button", name="Menu").click()
    visit.page.get_by_role("menuitem", name=name).click()
    visit.settled(before)


def loaded(visit, text, folder):
    """Load a specification, and wait for its answer."""
    (folder / "mine.toml").write_text(text, "utf-8")
    visit.page.get_by_role("tab", name="Specification").click()
    before = visit.asked
    visit.page.locator('input[type="file"][accept*=".toml"]').set_input_files(folder / "mine.toml")
    visit.settled(before)


def test_a_surface_that_cannot_be_made_is_told_beside_its_law_and_at_its_files(visit, tmp_path):
    page, text = visit.page, demo_text("operating-points")
    head, rest = text.split("[target]")
    page.get_by_role("tab", name="Take it").click()
    with page.expect_download():
        page.get_by_role("button", name="mould.csv").click()
    page.get_by_text("mould.csv was downloaded.").wait_for()
    loaded(visit, f"{head}[target]\n{NO_PART}\n[material]{rest.partition('[material]')[2]}", tmp_path)
    chip = page.locator(".bar .chip", has_text="; no part can be made")
    chip.wait_for()
    chip.focus()
    page.locator(".bar .details", has_text="No part can be made: the asperity at x = ").wait_for()
    page.get_by_role("tab", name="Take it").click()
    page.get_by_text("No part can be made: the asperity at x = ").last.wait_for()
    enabled = {
        name: page.get_by_role("button", name=name).is_enabled()
        for name in ("mould.csv", "block.stl", "surface.zip", "heights.csv", "spec.toml")
    }
    assert enabled == {
        "mould.csv": False, "block.stl": False, "surface.zip": False, "heights.csv": True, "spec.toml": True
    }  # fmt: skip
    assert not page.get_by_text("mould.csv was downloaded.").is_visible()


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


def test_plots_stay_where_they_are_when_the_hint_goes(visit):
    hint = visit.page.locator(".law-live span", has_text="Drag the points of the target law")
    hint.wait_for()
    parts = visit.page.locator(".explorer > section").all()
    places = [part.bounding_box() for part in parts]
    visit.drag(visit.handles()[0], 10, -10)
    hint.wait_for(state="hidden")
    assert [part.bounding_box() for part in parts] == places
    visit.page.reload()
    visit.settled()
    assert not hint.count()


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


def test_warnings_open_over_the_map(visit):
    page = visit.page
    visit.entered("limits.height_sd", "30 um")
    warnings = page.locator("section.surface .place-warnings summary")
    warnings.wait_for()
    size = page.locator("section.surface .box").first.bounding_box()
    warnings.click()
    page.locator("section.surface .over").wait_for()
    assert page.locator("section.surface .box").first.bounding_box() == size
    page.keyboard.press("Escape")
    page.locator("section.surface .over").wait_for(state="hidden")


def test_the_field_in_use_stays_where_it_is_when_warnings_come(visit):
    page = visit.page
    page.set_viewport_size({"width": 1440, "height": 820})
    field = page.locator('[data-key="limits.height_sd"]')
    field.focus()
    place = field.bounding_box()
    before = visit.asked
    field.fill("30 um")
    field.press("Enter")
    visit.settled(before)
    page.locator(".fields .cautious").first.wait_for()
    page.wait_for_function(
        "y => Math.abs(document.activeElement.getBoundingClientRect().y - y) < 2", arg=place["y"]
    )
    visit.page.get_by_text("It is assessed, not designed for").last.wait_for()
