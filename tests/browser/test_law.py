"""The law and the workshop in a browser: dragged, typed, refused, compared, and made into a part."""

import tomllib

import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.explorer.answer import answered
from metafem.explorer.history import State
from metafem.explorer.surface_data import asked_sites
from metafem.files import demo_text, parsed
from metafem.report import numbers
from tests.browser import WHOLE, after, drop, hold, take

FORCES = "load_N,friction_force_N\n0.1,0.12\n0.3,0.4\n0.6,0.8\n"

# The ends of both axes, and whether a zoom holds them.
AXES = """() => {
  const { x, y, zoomed } = getElement(document.querySelector('.law-plot'));
  return [x.low, x.high, y.low, y.high, zoomed];
}"""


def target(visit):
    """Return the target of the text."""
    return answered(State(visit.text), 1).specification.target


def said(visit):
    """Return what stands below the plot."""
    return visit.page.locator(".law-live span").inner_text()


def test_a_dragged_point_changes_the_text_and_a_refused_one_returns(visit):
    visit.drag("point-1", 12, -20)
    moved = target(visit)
    assert moved.rescaled_friction[1] > 1.7
    before = visit.asked
    x, y = hold(visit, "point-1")
    visit.page.mouse.move(x, y - 60, steps=4)
    visit.page.mouse.move(20.0, y - 160, steps=4)
    visit.page.locator(".handle.refused").wait_for()
    assert " N" in visit.page.locator(".law-refusal span").inner_text()
    assert visit.page.locator("path.achieved.old").count() == 1
    visit.page.mouse.up()
    visit.settled(before)
    visit.page.locator(".law-refusal").wait_for(state="detached")
    assert said(visit).startswith("Refused. The point is back to")
    visit.page.get_by_role("button", name="Why?").last.click()
    assert "asperities" in said(visit)  # the reason stays
    assert answered(State(visit.text), 1).current


def test_the_nearest_law_is_taken_and_every_kind_can_be_dragged(visit):
    page = visit.page
    for kind in ("linear", "bilinear", "power", "multilinear", "sampled", "operating-points"):
        after(visit, page.locator('[data-key="target.kind"]').select_option, kind)
        visit.drag(visit.handles()[-1], 8, -6)
        answer = answered(State(visit.text), 1)
        assert answer.current, (kind, answer.refused)
    before = visit.asked
    x, _ = hold(visit, "point-2")
    page.mouse.move(x, 100, steps=5)
    page.locator(".handle.refused").wait_for()
    page.mouse.up()
    visit.settled(before)
    kept = target(visit)
    after(visit, page.locator(".law-live .law-use").click)
    assert target(visit) != kept
    assert answered(State(visit.text), 1).current


def test_laws_are_shown_in_both_units_beside_pins_and_measured_points(visit):
    page, text = visit.page, visit.text
    law, legend = "() => getElement(document.querySelector('.law-plot')).answer", page.locator(".law-legend")
    page.get_by_role("button", name="Pin", exact=True).click()
    page.locator("path.pinned").wait_for(state="attached")
    first = page.evaluate(law)["achieved"]
    visit.drag("point-0", -15, 4)
    shown = page.evaluate(law)
    assert shown["pinned"] == first != shown["achieved"]
    after(visit, drop, visit, ".bar", "m.csv", FORCES.encode())
    assert "m.csv: 3 points" in legend.inner_text()
    assert page.evaluate(WHOLE)
    page.get_by_role("button", name="Unpin").click()
    page.locator("path.pinned").wait_for(state="detached")
    after(visit, page.get_by_role("button", name="Remove", exact=True).first.click)
    assert legend.locator(".measured").count() == 0
    after(visit, page.get_by_role("button", name="mm²", exact=True).click)
    page.locator("text.title", has_text="friction F/(σB) [mm²]").wait_for(state="attached")
    assert visit.text != text  # by the drag alone
    visit.drag("point-0", 5, -3)
    assert "mm^2" in visit.text.split("[material]")[0].split("rescaled_load =")[1]


def test_the_axes_are_zoomed_and_fitted(visit):
    page = visit.page
    fitted = page.evaluate(AXES)
    assert (fitted[0], fitted[2], fitted[4]) == (0, 0, False)
    place = visit.middle("point-1")
    page.locator('.handle[data-id="point-1"]').focus()
    page.keyboard.press("+")
    page.keyboard.press("+")
    assert visit.middle("point-1") == pytest.approx(place, abs=1)  # around the handle in focus
    low, high, bottom, _, zoomed = near = page.evaluate(AXES)
    assert zoomed
    assert (high - low) / fitted[1] == pytest.approx(0.64)
    assert low > 0.0 < bottom
    visit.drag("point-1", 6, -8)
    after(visit, page.keyboard.press, "ArrowUp")
    assert page.evaluate(AXES) == near  # in drags, too
    assert answered(State(visit.text), 1).current
    page.keyboard.press("0")
    assert page.evaluate(AXES)[0::2] == [0, 0, False]
    x, y = visit.middle("point-0")
    page.mouse.move(x, y)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -200)
    page.keyboard.up("Control")
    page.wait_for_function(f"() => ({AXES})()[4]")
    assert visit.middle("point-0") == pytest.approx((x, y), abs=1)
    page.get_by_role("button", name="Zoom out").click()
    page.get_by_role("button", name="Fit").click()
    assert page.evaluate(AXES)[4] is False


def value(visit, key):
    """Return the value of a key in the specification of a visit, None for none."""
    found = tomllib.loads(visit.text)
    for part in key.split("."):
        found = found.get(part, {})
    return None if found == {} else found


def chosen(visit, key, option):
    """Choose an option of the field of a key, and wait for the answer."""
    after(visit, visit.page.locator(f'[data-key="{key}"]').select_option, option)


def pressed(visit, keys):
    """Press keys beside all fields, and wait for the answer."""
    visit.page.locator(".bar h1").click()
    after(visit, visit.page.keyboard.press, keys)


def test_values_are_typed_refused_where_they_stand_and_undone(visit):
    page = visit.page
    visit.entered("limits.max_height", "300 um")
    assert value(visit, "limits.max_height") == "300 um"
    field = visit.entered("limits.max_height", "310")  # the unit is that of the value before
    page.wait_for_function("() => document.querySelector('#field-limits-max_height').value === '310 um'")
    least = visit.entered("limits.min_height", "12")
    wrong = page.locator("#field-limits-min_height-wrong")
    wrong.wait_for()
    assert "needs a unit" in wrong.inner_text()
    assert (least.input_value(), least.get_attribute("aria-invalid")) == ("12", "true")
    after(visit, page.get_by_role("button", name="Use 12 um").click)
    wrong.wait_for(state="detached")
    visit.entered("lattice.pitch", "-2 mm")
    page.locator("#field-lattice-pitch-wrong").wait_for()
    for _ in range(4):
        pressed(visit, "Control+z")
    assert (value(visit, "limits.max_height"), value(visit, "lattice.pitch")) == ("300 um", "1.5 mm")
    page.wait_for_function("() => document.querySelector('#field-limits-max_height').value === '300 um'")
    pressed(visit, "Control+y")
    assert value(visit, "limits.max_height") == "310 um"
    pressed(visit, "Control+Shift+z")
    assert value(visit, "limits.min_height") == "12"
    page.wait_for_function("() => document.querySelector('#field-limits-max_height').value === '310 um'")
    visit.entered("limits.max_height", "320")
    after(visit, field.press, "Control+z")
    assert value(visit, "limits.max_height") == "310 um"


def test_kinds_and_sections_are_changed(visit):
    page = visit.page
    chosen(visit, "target.kind", "bilinear")
    page.locator('[data-key="target.slopes"]').first.wait_for()  # the fields follow at their own pace
    assert page.locator('[data-key="target.slopes"]').count() == 1
    assert value(visit, "target.kind") == "bilinear"
    page.locator('[data-section="contact"] summary').click()
    chosen(visit, "contact.kind", "jkr")
    visit.entered("contact.adhesion_energy", "2 N/m")
    assert value(visit, "contact") == {"kind": "jkr", "adhesion_energy": "2 N/m"}
    chosen(visit, "contact.kind", "")
    assert value(visit, "contact") is None
    page.locator('[data-section="tools"] summary').click()
    after(visit, page.get_by_role("button", name="Add Tools").click)
    assert (value(visit, "tools.radii"), value(visit, "lattice.radius")) == (["300 um", "526 um"], None)
    after(visit, page.get_by_role("button", name="Remove Tools").click)
    assert (value(visit, "tools"), value(visit, "lattice.radius")) == (None, "526 um")


def chosen_file(page, button, path):
    """Choose a file in the dialog that a button opens."""
    with page.expect_file_chooser() as dialog:
        page.get_by_role("button", name=button).click()
    dialog.value.set_files(path)


def test_the_text_and_the_fields_follow_each_other(visit, tmp_path):
    page = visit.page
    page.get_by_role("tab", name="Specification").click()
    text = page.locator(".cm-content")
    page.locator(".cm-line span").first.wait_for()  # coloured, which draws the lines again
    text.get_by_text("[limits]").click()
    page.keyboard.press("End")
    page.keyboard.press("End")  # the line is wrapped
    page.keyboard.type("\nheight_step = 6", delay=20)  # no hand is quicker, and the editor loses its place
    page.locator(".problems", has_text="height_step = 6 needs a unit").wait_for()
    page.get_by_role("tab", name="Workshop").click()
    page.locator("#field-limits-height_step-wrong").wait_for()
    visit.entered("limits.height_step", "6 um")
    page.get_by_role("tab", name="Specification").click()
    text.get_by_text('height_step = "6 um"').wait_for()
    text.get_by_text("[limits]").click()
    after(visit, page.keyboard.type, "[")
    page.get_by_role("tab", name="Workshop").click()
    page.get_by_role("button", name="Edit the text").click()
    text.wait_for()
    (tmp_path / "mine.toml").write_text(demo_text("linear"), "utf-8")
    (tmp_path / "picture.toml").write_bytes(bytes(range(256)))
    after(visit, chosen_file, page, "Load…", tmp_path / "mine.toml")
    assert visit.text == demo_text("linear")
    chosen_file(page, "Load…", tmp_path / "picture.toml")
    page.get_by_text("picture.toml is not a text in UTF-8.").wait_for()
    assert visit.text == demo_text("linear")
    after(visit, drop, visit, ".law-svg", "bilinear.toml", demo_text("bilinear").encode())
    assert visit.text == demo_text("bilinear")
    (tmp_path / "law.csv").write_text("load_N,friction_force_N\n1,2\n", "utf-8")
    after(visit, chosen_file, page, "Measured points…", tmp_path / "law.csv")
    page.locator(".law-legend", has_text="law.csv: 1 point").wait_for()


def begun(visit, name):
    """Start over from an example, and wait for its answer."""
    visit.page.get_by_role("button", name="Menu").click()
    after(visit, visit.page.get_by_role("button", name=name, exact=True).click)


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


def test_the_numbers_are_those_of_the_specification_and_follow_it(visit):
    page = visit.page
    page.get_by_role("tab", name="How sure").click()
    for right in (0, 12):
        if right:
            visit.drag("point-1", right, -right)
        answer = answered(State(visit.text), 1)
        for value, name in numbers(answer.design):
            page.locator(".sure-figures tr", has_text=name).get_by_text(value).wait_for()


@pytest.fixture
def press(visit):
    """Press what has a name: a button, or a control of another role."""
    return lambda name, role="button": visit.page.get_by_role(role, name=name).click()


def test_a_law_of_ones_own_becomes_a_mould_table(visit, press, tmp_path):
    page, before = visit.page, visit.text
    assert page.get_by_text("“Take it” has the mould table").is_visible()
    for handle, right, down in (("point-0", -15, 4), ("point-1", -10, -12), ("point-2", 8, 15)):
        visit.drag(handle, right, down)
    after(visit, page.get_by_role("combobox", name="Model").first.select_option, label="layer")
    assert visit.text != before
    assert page.locator(".bar .chip").inner_text().startswith(("exact", "reached", "refined"))
    press("Take it", "tab")
    table, spec = (
        take(page, lambda name=name: press(name), tmp_path / name) for name in ("mould.csv", "spec.toml")
    )
    command = ["design", str(spec), "-o", str(tmp_path / "surface")]
    assert CliRunner().invoke(cli.main, command).exit_code == 0
    assert table.read_bytes() == (tmp_path / "surface" / "mould.csv").read_bytes()
    assert 'kind = "layer"' in spec.read_text("utf-8")


def test_a_part_of_ones_own_becomes_a_mould_table(visit, press, tmp_path):
    page, before = visit.page, visit.text
    press("New part")
    for name, text in (
        ("Block: width", "15 x 15 x 5,5"), ("Asperities", "9 × 9"), ("Friction coefficient", "1,5"),
    ):  # fmt: skip
        page.get_by_label(name).fill(text)
    after(visit, press, "Make it")
    page.locator(".bar .chip", has_text="misfit").wait_for()
    press("Take it", "tab")
    table = take(page, lambda: press("mould.csv"), tmp_path / "mould.csv")
    rows = [line for line in table.read_text("utf-8").splitlines() if line[:1].isdigit()]
    assert len(rows) == 9 * 9
    after(visit, press, "Undo")
    assert visit.text == before


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
    kept, empty = asked_sites(State(visit.text).table)
    assert ([*kept], empty) == ([9], [10])
    keys.to("max height")
    page.keyboard.type("280")
    keys.changes("Enter")
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


def test_tab_runs_through_every_part_and_all_have_names_and_roles(keys):
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
    page = keys.page
    tree = page.locator("body").aria_snapshot()
    assert tree.count("- main:") == 1
    for words in ('slider "Load"', 'combobox "Target, kind"', 'region "Law"'):
        assert words in tree, words
    page.get_by_role("tab", name="Take it").click()
    page.get_by_role("button", name="Copy the command").wait_for()
    named = page.locator("section.inspector").aria_snapshot()
    assert "- button\n" not in named
    assert not named.endswith("- button")
