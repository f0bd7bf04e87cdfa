"""The workshop in a browser: fields, the specification as text, undo and redo, and the layout of the page."""

import tomllib

from metafem.files import demo_text
from tests.browser.hands import after, drop


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
    assert wrong.inner_text().startswith("Needs a unit; write for example 10 um.")
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
    after(visit, field.press, "ArrowUp")
    assert value(visit, "limits.max_height") == "320 um"
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
    after(visit, page.get_by_role("button", name="Add Choice of tools").click)
    assert (value(visit, "tools.radii"), value(visit, "lattice.radius")) == (["300 um", "526 um"], None)
    after(visit, page.get_by_role("button", name="Remove Choice of tools").click)
    assert (value(visit, "tools"), value(visit, "lattice.radius")) == (None, "526 um")


# Types a line, sends it, and gets an answer that was on its way meanwhile; returns the text in the editor.
CROSSED = """() => {
  const element = getElement(document.querySelector('.editor')), { state } = element.editor;
  element.editor.dispatch({ changes: { from: 0, insert: '# mine\\n' } });
  element.use();
  element.show({ text: state.doc.toString(), problems: [], tables: [], taken: element.count - 1 });
  return element.editor.state.doc.toString();
}"""


def test_an_answer_on_its_way_leaves_what_was_typed(visit):
    page, before = visit.page, visit.asked
    page.get_by_role("tab", name="Specification").click()
    page.locator(".cm-content").get_by_text("max_height").wait_for()
    assert page.evaluate(CROSSED).startswith("# mine\n")
    visit.settled(before)
    assert visit.text.startswith("# mine\n")


def test_the_text_and_the_fields_follow_each_other(visit, tmp_path):
    page = visit.page
    page.get_by_role("tab", name="Specification").click()
    text = page.locator(".cm-content")
    text.get_by_text("max_height").wait_for()
    text.get_by_text("[limits]").click()
    page.keyboard.press("End")
    page.keyboard.press("End")  # the line is wrapped
    page.keyboard.type("\nheight_step = 6", delay=20)  # no hand is quicker, and the editor loses its place
    page.locator(".problems", has_text="height_step = 6 needs a unit").wait_for()
    page.get_by_role("button", name="Line ").wait_for()
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
    files = page.locator('input[type="file"][accept*=".toml"]')
    after(visit, files.set_input_files, tmp_path / "mine.toml")
    assert visit.text == demo_text("linear")
    files.set_input_files(tmp_path / "picture.toml")
    page.get_by_text("picture.toml is not a text in UTF-8.").wait_for()
    assert visit.text == demo_text("linear")
    after(visit, drop, visit, ".law-svg", "bilinear.toml", demo_text("bilinear").encode())
    assert visit.text == demo_text("bilinear")
    drop(visit, ".bar", "law.csv", b"load_N,friction_force_N\n1,2\n")
    page.get_by_text("law.csv is a table.").wait_for()
