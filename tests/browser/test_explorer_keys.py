"""The explorer by keys alone: from the target law to the mould table, with the focus where it is expected."""

import pytest

from metafem.explorer.surface_data import asked_sites
from metafem.files import parsed
from tests.browser.hands import after, take

# Name, role and part of what is in focus, and whether the focus is seen: an outline, or a ring at a point.
FOCUS = """() => {
  const at = document.activeElement, drawn = getComputedStyle(at.closest('.cm-editor') ?? at);
  const ring = at.querySelector(':scope > .touch'), icons = /^(download|link)\\n/;
  return {
    name: at.ariaLabel ?? at.labels?.[0]?.innerText ?? at.innerText?.replace(icons, '') ?? '',
    role: at.role ?? at.tagName.toLowerCase(), part: at.closest('section, header')?.className ?? '',
    seen: (drawn.outlineStyle !== 'none' && parseFloat(drawn.outlineWidth) >= 2)
      || (ring !== null && getComputedStyle(ring).stroke !== 'none'),
  };
}"""

# More presses of Tab than the page has controls.
MOST = 80


class Keys:
    """Presses keys on a page, and looks what is in focus."""

    def __init__(self, visit):
        self.visit, self.page = visit, visit.page

    @property
    def focus(self):
        return self.page.evaluate(FOCUS)

    def press(self, *keys):
        for key in keys:
            self.page.keyboard.press(key)

    def changes(self, *keys):
        """Press keys and wait for the answer."""
        after(self.visit, self.press, *keys)

    def to(self, name, key="Tab"):
        """Press Tab until the focus is on a control whose name begins with a text, and is seen."""
        for _ in range(MOST):
            self.press(key)
            focus = self.focus
            if focus["name"].strip().lower().startswith(name.lower()):
                self.page.wait_for_function(f"() => ({FOCUS})().seen")  # the editor shows it a moment later
                return
        raise AssertionError(f"{key} does not lead to {name}")

    @property
    def target(self):
        return parsed(self.visit.text).target


@pytest.fixture
def keys(visit):
    return Keys(visit)


def test_a_law_becomes_a_mould_table(keys, tmp_path):
    page, visit = keys.page, keys.visit
    keys.to("point 2 of 3")
    friction = keys.target.rescaled_friction[1]
    keys.changes("Shift+ArrowUp")
    assert keys.target.rescaled_friction[1] > friction
    keys.changes("a")
    assert keys.focus["name"].startswith("point 3 of 4")
    assert page.locator(".law-live span").inner_text().startswith("Added point 3 of 4: load")
    keys.changes("Delete")
    assert keys.focus["name"].startswith("point 3 of 3")
    assert page.locator(".law-live span").inner_text() == "Point removed."
    keys.changes("Control+z")
    keys.to("point 4 of 4")
    keys.changes("Control+z")
    assert keys.focus["name"].startswith("point 3 of 3")
    keys.to("Map of the heights")
    keys.press("ArrowUp", "ArrowRight")
    keys.changes("p")
    keys.press("ArrowRight", "Enter")
    assert keys.focus["name"].startswith("Keep this height")
    keys.to("Leave this site empty")
    keys.changes("Enter")
    assert keys.focus["name"].startswith("Map of the heights")
    asked = asked_sites(visit.text)
    assert (set(asked.pinned), asked.empty) == ({9}, {10})
    keys.to("Largest height")
    keys.changes("ArrowUp")
    assert 'max_height = "280 um"' in visit.text
    keys.changes("Control+z")
    assert 'max_height = "270 um"' in visit.text
    keys.to("Workshop", "Shift+Tab")
    keys.press("ArrowRight")
    assert keys.focus["name"] == "Specification"
    keys.press("Enter")
    page.locator(".cm-content").get_by_text("max_height").wait_for()
    keys.to("Specification")
    assert keys.focus["role"] == "textbox"
    keys.press("Control+Home")
    keys.changes("#", "Enter")
    assert visit.text.startswith("#\n")
    keys.press("Tab")
    assert keys.focus["role"] != "textbox"
    keys.to("Specification", "Shift+Tab")
    keys.to("Specification", "Shift+Tab")
    keys.press("ArrowRight", "ArrowRight", "Enter")
    assert keys.focus["name"] == "Take it"
    keys.to("mould.csv")
    table = take(page, lambda: keys.press("Enter"), tmp_path / "mould.csv")
    assert table.read_text("utf-8").count("\n") > 50


def test_tab_runs_through_every_part_in_the_order_of_reading(keys):
    keys.page.locator("h1").click()
    seen = []
    for _ in range(MOST):
        keys.press("Tab")
        focus = keys.focus
        if focus["role"] == "body":
            break
        assert focus["seen"], focus
        assert focus["name"].strip(), focus
        seen.append(focus["part"].split(" ")[0])
    parts = [part for part, before in zip(seen, ["", *seen[:-1]], strict=True) if part != before]
    assert parts == ["bar", "law", "surface", "inspector"]


def test_the_names_and_roles_are_those_of_the_page(keys):
    page = keys.page
    tree = page.locator("body").aria_snapshot()
    assert tree.count("- main:") == 1
    for words in ('slider "load at which contacts are shown"', 'combobox "Target law, kind"', 'region "Law"'):
        assert words in tree, words
    page.get_by_role("tab", name="Take it").click()
    page.get_by_role("button", name="Copy the command").wait_for()
    named = page.locator("section.inspector").aria_snapshot()
    assert "- button\n" not in named
    assert not named.endswith("- button")
