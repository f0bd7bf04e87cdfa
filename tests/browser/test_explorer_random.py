"""Hundreds of random steps on the page: nothing fails, and it shows what `metafem design` computes."""

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.errors import Infeasible, InvalidInput
from metafem.files import demo_text, parsed, read_spec, result_tables
from metafem.inversion import DesignStatus
from validation.scenes.explorer import served, visited

pytestmark = pytest.mark.slow

STEPS, BATCH = 1000, 100

TABLES = ("heights.csv", "law.csv")

# Middles of all handles [pixels].
MIDDLES = """() => [...document.querySelectorAll('.handle')].map(each => {
  const box = each.getBoundingClientRect();
  return [each.dataset.id, box.x + box.width / 2, box.y + box.height / 2];
})"""

# Drags a handle through places, some milliseconds apart, by the events of a mouse. The mouse of the driver
# waits for a frame with each move.
DRAGGED = """async ([id, places]) => {
  const node = document.querySelector(`.handle[data-id="${id}"]`);
  if (!node) return;
  const said = (kind, [x, y], buttons) => node.dispatchEvent(new PointerEvent(kind, {
    clientX: x, clientY: y, pointerId: 1, isPrimary: true, button: 0, buttons, bubbles: true }));
  said('pointerdown', places[0], 1);
  for (const place of places.slice(1)) {
    said('pointermove', place, 1);
    await new Promise(done => setTimeout(done, 5));
  }
  said('pointerup', places.at(-1), 0);
}"""

# Presses keys on an element in focus.
PRESSED = """([where, keys]) => {
  const node = document.querySelector(where);
  node?.focus();
  for (const name of keys) {
    const key = { key: name.replace('Shift+', ''), shiftKey: name.startsWith('Shift+') };
    for (const kind of ['keydown', 'keyup']) {
      node?.dispatchEvent(new KeyboardEvent(kind, { ...key, bubbles: true, cancelable: true }));
    }
  }
}"""

# Keys and texts of all fields, apart from the numbers of asperities, which set the time of a design.
FIELDS = """() => [...document.querySelectorAll('.fields input.text')]
  .filter(each => each.dataset.key !== 'lattice.shape').map(each => [each.dataset.key, each.value])"""

# Chooses an entry of a list by a number from 0 to 1.
CHOSEN = """([name, part]) => {
  const list = document.querySelector(name);
  if (!list || list.disabled) return;
  list.selectedIndex = Math.floor(part * list.options.length);
  list.dispatchEvent(new Event('change', { bubbles: true }));
}"""

# Clicks a button of the head a few times.
CLICKED = """([word, times]) => {
  const named = each => (each.ariaLabel ?? each.innerText).startsWith(word);
  const button = [...document.querySelectorAll('button')].find(named);
  for (let i = 0; i < times; i++) button.click();
}"""


class Hand:
    """Makes random steps with the mouse and the keyboard."""

    def __init__(self, visit, seed):
        self.visit, self.page, self.rng = visit, visit.page, np.random.default_rng(seed)
        chances = {
            self.drag: 0.40, self.nudge: 0.14, self.undo: 0.13, self.redo: 0.08, self.add: 0.05,
            self.remove: 0.04, self.site: 0.07, self.field: 0.06, self.kind: 0.02, self.model: 0.01,
        }  # fmt: skip
        self.steps, self.chances = list(chances), list(chances.values())

    def step(self):
        """Make a step."""
        self.steps[self.rng.choice(len(self.steps), p=self.chances)]()

    def chosen(self):
        """Return a random handle with its middle, or None."""
        found = self.page.evaluate(MIDDLES)
        return found[self.rng.integers(len(found))] if found else None

    def drag(self):
        """Drag a handle, at times far out of what can be reached."""
        if (handle := self.chosen()) is None:
            return
        name, x, y = handle
        reach = 200.0 if self.rng.random() < 0.05 else 12.0
        moves = self.rng.uniform(-reach, reach, (3, 2)).tolist()
        places = [[x, y], *([x + right, y + down] for right, down in moves)]
        if self.rng.random() < 0.9:
            self.page.evaluate(DRAGGED, [name, places])
            return
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        for place in places[1:]:
            self.page.mouse.move(*place)
        self.page.mouse.up()

    def press(self, key, handle):
        """Press a key on a handle."""
        self.page.evaluate(PRESSED, [f".handle[data-id='{handle}']", [key]])

    def nudge(self):
        """Move a handle by the keyboard."""
        if (handle := self.chosen()) is not None:
            key = self.rng.choice(["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"])
            self.press(("Shift+" if self.rng.random() < 0.2 else "") + key, handle[0])

    def add(self):
        """Add a point."""
        if (handle := self.chosen()) is not None:
            self.press("a", handle[0])

    def remove(self):
        """Remove a point."""
        if (handle := self.chosen()) is not None:
            self.press("Delete", handle[0])

    def site(self):
        """Keep the height of a site, leave it empty, or let the design choose it."""
        keys = self.rng.choice(["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"], 2)
        last = self.rng.choice(["p", "e", "r"])
        self.page.evaluate(PRESSED, [".surface-view svg", [*keys.tolist(), str(last)]])

    def field(self):
        """Type a value into a field: a number near the present one, or at times what it cannot be."""
        fields = self.page.evaluate(FIELDS)
        key, given = fields[self.rng.integers(len(fields))]
        number = re.search(r"[\d.]+", given)
        if number is None or self.rng.random() < 0.2:
            text = self.rng.choice(["", "12", "abc", "-5 um", "1e400 mm", "]", '"'])
        else:
            near = f"{float(number[0]) * self.rng.uniform(0.9, 1.1):.3g}"
            text = given.replace(number[0], near, 1)
        self.page.evaluate("probe.typed", [key, text])

    def kind(self):
        """Choose another kind of target."""
        self.page.evaluate(CHOSEN, ['select[data-key="target.kind"]', self.rng.random()])

    def model(self):
        """Choose another model among those that take milliseconds."""
        model = self.rng.choice(["independent", "mean-field", "half-space", "layer"])
        self.page.locator('select[aria-label="Model"]').select_option(model)

    def undo(self, word="Undo"):
        """Undo a few steps."""
        self.page.evaluate(CLICKED, [word, int(self.rng.integers(1, 4))])

    def redo(self):
        """Redo a few steps."""
        self.undo("Redo")


def downloaded(visit, name):
    """Take a file from the page."""
    with visit.page.expect_download() as download:
        visit.page.locator(f'[data-take="{name}"]').click()
    return Path(download.value.path()).read_bytes()


def compared(visit):
    """Compare what the page shows with the design of its specification; return whether there is one."""
    visit.page.keyboard.press("Escape")  # a press of the mouse can end on the button of the help
    visit.page.get_by_role("tab", name="Take it").click()
    text = downloaded(visit, "spec.toml").decode()
    refused = visit.page.evaluate("() => getElement(document.querySelector('.law-plot')).plot.data.refusal")
    words, tables = "", {}
    try:
        specification = parsed(text, {})
        tables = result_tables(specification.design(), specification.part)
    except (InvalidInput, Infeasible) as error:
        words = str(error)
    assert bool(refused) == bool(words), (refused, words)
    if words:
        return False
    assert {name: downloaded(visit, name) for name in TABLES} == {
        name: tables[name].encode() for name in TABLES
    }
    return True


def commanded(visit, folder):
    """Compare the files of the page with those of `metafem design` of its specification."""
    spec = folder / "spec.toml"
    spec.write_bytes(downloaded(visit, "spec.toml"))
    done = CliRunner().invoke(cli.main, ["design", str(spec), "-o", str(folder / "surface")])
    # the steps may end at a target that the design misses, for which the command ends with 1
    missed = read_spec(spec).design().status is DesignStatus.MISSED
    assert done.exit_code == int(missed), done.output
    for name in TABLES:
        assert downloaded(visit, name) == (folder / "surface" / name).read_bytes()


def test_random_steps_fail_nowhere_and_end_at_the_design_of_the_specification(browser, tmp_path):
    # without a part: no block can be made of a summit that random steps lead to the base plane
    text = re.sub(r"\[(block|part)\].*?(?=\n\[|\Z)", "", demo_text("operating-points"), flags=re.DOTALL)
    spec = tmp_path / "points.toml"
    spec.write_text(text, "utf-8")
    with served(spec) as server, visited(browser, server) as visit:
        hand = Hand(visit, 0)
        for _ in range(STEPS // BATCH):
            visit.page.get_by_role("tab", name="Workshop").click()
            visit.page.locator(".fields input.text").first.wait_for()
            for _ in range(BATCH):
                hand.step()
            visit.at_rest()
            while not compared(visit):
                hand.undo()
                visit.at_rest()
            assert visit.errors == []
            assert server.said == "", server.said
        commanded(visit, tmp_path)
