"""A first visit: from the start to the mould table of one's own law, by what stands on the page alone."""

import re

from click.testing import CliRunner

from metafem import cli

# Steps of the hand to the table: three points, the model, the tab, the file.
MOST_STEPS = 6

# Clicks and typed fields from the first page to the table of a part of one's own.
MOST_OF_OWN = 8


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

    def presses(self, name):
        """Press a button."""
        self.page.get_by_role("button", name=name).click()
        self.steps += 1

    def types(self, name, text):
        """Type into a field."""
        self.page.get_by_label(name).fill(text)
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
    assert visit.page.get_by_text("“Take it” has the mould table").is_visible()
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


def test_a_part_of_ones_own_becomes_a_mould_table_in_eight_steps(visit, tmp_path):
    hand, before, asked = Hand(visit), visit.text, visit.asked
    hand.presses("New part")
    hand.types("Block: width", "11 x 11 x 5,5")
    hand.types("Asperities", "10 × 10")
    hand.types("Friction coefficient", "1,8")
    hand.presses("Make it")
    hand.presses("Use asperities 9 × 9")
    visit.settled(asked)
    assert visit.page.locator(".bar .chip").inner_text().startswith("meets the target")
    hand.opens("Take it")
    table = hand.takes("mould.csv", tmp_path)
    assert hand.steps <= MOST_OF_OWN
    rows = [line for line in table.read_text("utf-8").splitlines() if line[:1].isdigit()]
    assert len(rows) == 9 * 9 + 4  # with the alignment caps
    visit.page.get_by_role("button", name="Undo").click()
    visit.settled(asked + 1)
    assert visit.text == before


def test_a_law_is_pinned_beside_the_next_one_after_a_tour(visit):
    hand, page = Hand(visit), visit.page
    hand.presses("Take a one-minute tour")
    for number in range(1, 5):
        page.get_by_text(f"{number} of 5").wait_for()
        hand.presses("Next")
    hand.presses("Done")
    assert page.locator(".tour-words").count() == 0
    hand.presses("Pin as A")
    page.get_by_role("button", name="Unpin").wait_for()
    hand.drags("point 1 of 3", -15, 4)
    page.reload()
    page.get_by_role("button", name="Unpin").wait_for()
    assert page.get_by_role("button", name="Take a one-minute tour").count() == 0
    hand.opens("A and B")
    load = page.get_by_role("row", name="Largest load").get_by_role("cell")
    load.first.wait_for()
    assert load.count() == 2
    page.get_by_label("Colour of the sites").select_option("difference from A")
    page.get_by_text("height, B − A [µm]").wait_for()
    hand.presses("Unpin")
    page.get_by_text("Nothing is pinned").wait_for()
    page.get_by_text("height [µm]").wait_for()
