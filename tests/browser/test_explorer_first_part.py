"""A first visit: from the start to the mould table of one's own law, by what stands on the page alone."""

import re

import pytest
from click.testing import CliRunner

from metafem import cli

pytestmark = pytest.mark.slow

# Steps of the hand to the table: three points, the model, the tab, the file.
MOST_STEPS = 6


class Hand:
    """Does what a person does, and counts it."""

    def __init__(self, visit):
        self.visit, self.page, self.steps = visit, visit.page, 0

    def drags(self, name, right, down):
        """Drag a point of the law [pixels]."""
        point = self.page.get_by_role("slider", name=re.compile(f"^{name}")).bounding_box()
        x, y, before = point["x"] + point["width"] / 2, point["y"] + point["height"] / 2, self.visit.asked
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + right, y + down, steps=5)
        self.page.mouse.up()
        self.visit.settled(before)
        self.steps += 1

    def chooses(self, name, option):
        """Choose from the first list of a name."""
        before = self.visit.asked
        self.page.get_by_role("combobox", name=name).first.select_option(label=option)
        self.visit.settled(before)
        self.steps += 1

    def opens(self, name):
        """Open a tab."""
        self.page.get_by_role("tab", name=name).click()
        self.steps += 1

    def takes(self, name, folder):
        """Download a file."""
        with self.page.expect_download() as download:
            self.page.get_by_role("button", name=name).click()
        self.steps += 1
        download.value.save_as(folder / name)
        return folder / name


def test_a_law_of_ones_own_becomes_a_mould_table_in_six_steps(visit, tmp_path):
    hand = Hand(visit)
    assert visit.page.get_by_text("The tab “Take it” has the mould table").is_visible()
    before = visit.text
    hand.drags("point 1 of 3", -15, 4)
    hand.drags("point 2 of 3", -10, -12)
    hand.drags("point 3 of 3", 8, 15)
    hand.chooses("Model", "layer")
    assert visit.text != before
    assert visit.page.locator(".bar .chip").inner_text().startswith("meets the target")
    hand.opens("Take it")
    table = hand.takes("mould.csv", tmp_path)
    assert hand.steps <= MOST_STEPS
    hand.takes("spec.toml", tmp_path)
    command = ["design", str(tmp_path / "spec.toml"), "-o", str(tmp_path / "surface")]
    assert CliRunner().invoke(cli.main, command).exit_code == 0
    assert table.read_bytes() == (tmp_path / "surface" / "mould.csv").read_bytes()
    assert 'kind = "layer"' in (tmp_path / "spec.toml").read_text("utf-8")


def test_what_was_said_of_a_drag_goes_with_the_next_text(visit):
    hand, words = Hand(visit), visit.page.get_by_text("Refused. The point is back")
    hand.drags("point 3 of 3", 0, -150)
    words.wait_for()
    field = visit.page.get_by_label("Largest height")
    before = visit.asked
    field.fill("280 um")
    field.press("Enter")
    visit.settled(before)
    words.wait_for(state="hidden")
    hand.chooses("Target", "straight line (linear)")
    hand.drags("slope", 0, -15)
    slope = re.search(r"^slope = (\S+)", visit.text, re.MULTILINE)[1]
    visit.page.get_by_text(re.compile(rf"^slope {slope}.*: load")).wait_for()
