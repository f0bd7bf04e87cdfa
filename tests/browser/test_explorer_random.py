"""Hundreds of random steps on the page: nothing fails, and it shows what `metafem design` computes."""

import re
from pathlib import Path

import numpy as np
import pytest

from metafem.errors import Infeasible, InvalidInput
from metafem.files import demo_text, parsed, result_tables
from validation.scenes.explorer import served, visited

pytestmark = pytest.mark.nightly

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
    refused = visit.page.evaluate("() => getElement(document.querySelector('.law-plot')).plot.data.refusal")
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
