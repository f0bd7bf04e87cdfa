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
    visit.page.get_by_label("Start over", exact=True).select_option(name)
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
    page.locator(".bar .chip.part").wait_for()
    assert page.locator(".bar .chip").all_inner_texts()[1:] == ["no part can be made"]
    page.get_by_role("tab", name="Take it").click()
    page.get_by_text("No part can be made: asperity ").last.wait_for()
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
    begun(visit, "first")
    assert visit.text == demo_text("operating-points")
    for _ in range(2):
        before = visit.asked
        visit.page.get_by_role("button", name="Undo").click()
        visit.settled(before)
    assert visit.text == mine


def test_plots_stay_where_they_are_when_the_hint_goes(visit):
    parts = visit.page.locator(".explorer > section").all()
    places = [part.bounding_box() for part in parts]
    visit.drag(visit.handles()[0], 10, -10)
    visit.page.locator(".hint.closed").wait_for(state="attached")
    assert [part.bounding_box() for part in parts] == places
    visit.page.reload()
    visit.settled()
    assert not visit.page.locator(".hint").count()
