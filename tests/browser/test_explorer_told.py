"""Messages of the page: in its own words, readable, and gone when they are settled."""

import pytest

pytestmark = pytest.mark.slow

# Contrast of the text of an element with its background, both opaque.
CONTRAST = """node => {
  const light = colour => {
    const [r, g, b] = colour.match(/[\\d.]+/g).map(Number)
      .map(part => part / 255).map(part => part <= 0.03928 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const { color, backgroundColor } = getComputedStyle(node);
  const [low, high] = [light(color), light(backgroundColor)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
}"""


@pytest.mark.parametrize("theme", ["Light", "Dark"])
def test_a_message_can_be_read_and_goes_with_the_next_success(visit, theme):
    page = visit.page
    page.get_by_role("button", name=theme, exact=True).click()
    page.evaluate("() => { location.hash = 'm1.damaged'; }")
    message = page.locator(".q-notification")
    message.wait_for()
    assert message.evaluate(CONTRAST) > 4.5
    visit.entered("limits.max_height", "271 um")
    message.wait_for(state="detached")


def test_numbers_as_people_write_them_are_taken(visit):
    visit.entered("lattice.pitch", "1,6 mm")
    field = visit.page.locator('[data-key="lattice.pitch"]')
    assert field.input_value() == "1.6 mm"
    visit.entered("limits.height_step", ".8")
    before = visit.asked
    visit.page.get_by_role("button", name="Use 0.8 um").click()
    visit.settled(before)
    assert visit.page.locator('[data-key="limits.height_step"]').input_value() == "0.8 um"
