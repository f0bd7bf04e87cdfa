"""A first visit: from the start to the mould table of one's own law, by what stands on the page alone."""

import pytest
from click.testing import CliRunner

from metafem import cli
from tests.browser.hands import after, take


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
    assert page.locator(".bar .chip").inner_text().startswith("meets the target")
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


def test_a_law_is_pinned_beside_the_next_one(visit, press):
    page = visit.page
    press("Pin")
    pinned = page.locator("path.pinned")
    pinned.wait_for(state="attached")
    laws = "() => getElement(document.querySelector('.law-plot')).plot.data"
    first = page.evaluate(laws)["achieved"]
    visit.drag("point-0", -15, 4)
    shown = page.evaluate(laws)
    assert shown["pinned"] == first != shown["achieved"]
    press("Unpin")
    pinned.wait_for(state="detached")
