"""No handler of the page reads a text or computes in the event loop, where others would wait for it."""

import pytest

from validation.scenes.explorer import served, visited

pytestmark = pytest.mark.slow

# Runs the command with functions that tell where they were called: those that take long where texts are long
# or surfaces large. They are replaced before the panels import them.
WATCHED = """
import asyncio, functools, importlib, sys

def watched(owner, name):
    function = getattr(owner, name)
    @functools.wraps(function)
    def call(*given, **named):
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            return function(*given, **named)
        print(f"{function.__qualname__} was called in the event loop", file=sys.stderr, flush=True)
        return function(*given, **named)
    setattr(owner, name, call)

NAMES = {
    "answer": "answered specification_of planned",
    "text.handles": "scene_of moved added removed",
    "text.kinds": "with_kind",
    "text.fields": "with_field",
    "text.link": "to_link from_link restored",
    "law.law_data": "law_data",
    "law.dropped": "read_points as_target",
    "law.nearest": "with_nearest",
    "law.reach": "reach_of",
    "certainty.band": "tolerance_band",
    "certainty.places": "warnings_by_place",
    "law.further": "other_law",
    "surface.surface_data": "site_data layout_data",
    "surface.contact_data": "contact_data press_data",
    "surface.sites_text": "edited",
    "workshop.changes": "with_choice with_section without_section",
    "workshop.form": "contents",
    "workshop.editor": "placed",
    "workshop.loading": "loaded",
    "certainty.panel": "figure_data study_data",
    "take.files": "specification_file tables_of made_files archive",
}
for module, names in NAMES.items():
    for name in names.split():
        watched(importlib.import_module(f"metafem.explorer.{module}"), name)
from metafem.files import Specification
watched(Specification, "design")
from metafem import cli
cli.main()
"""

# A table that is dropped onto the law, and a specification that is dropped onto the head.
DROPPED = """([place, name, text]) => {
  const files = new DataTransfer();
  files.items.add(new File([text], name));
  document.querySelector(place).dispatchEvent(
    new DragEvent('drop', { dataTransfer: files, bubbles: true, cancelable: true }));
}"""


def test_every_handler_leaves_the_event_loop_free(browser):
    with served(program=("-c", WATCHED)) as server, visited(browser, server) as visit:
        every_handler(visit)
        assert visit.errors == []
        assert server.said == ""


def every_handler(visit):
    """Do all that a hand can do on the page."""
    page = visit.page

    def made(step, *given):
        before = visit.asked
        step(*given)
        visit.settled(before)

    def pressed(name, key):
        page.locator(f'.handle[data-id="{name}"]').focus()
        page.keyboard.press(key)

    def typed(key, text):
        page.locator(f'[data-key="{key}"]').fill(text)
        page.locator(f'[data-key="{key}"]').press("Enter")

    visit.drag("point-1", 8, -12)
    made(pressed, "point-1", "a")
    made(pressed, "point-2", "Delete")
    made(page.locator('[data-key="target.kind"]').select_option, "bilinear")
    made(typed, "limits.max_height", "300 um")
    made(page.keyboard.press, "Control+z")
    table = "load_N,friction_force_N\n0.1,0.12\n0.3,0.4\n0.6,0.8\n"
    made(page.evaluate, DROPPED, [".law-plot", "m.csv", table])
    made(page.get_by_role("button", name="Use as target").click)
    made(page.get_by_role("button", name="Remove", exact=True).first.click)
    link = visit.page.url
    made(page.get_by_label("Model", exact=True).select_option, "layer")
    made(page.evaluate, "link => { location.hash = new URL(link).hash; }", link)
    page.get_by_role("tab", name="How sure").click()
    page.locator(".certainty .figure-table").first.wait_for()
    page.get_by_role("tab", name="Take it").click()
    for name in ("spec.toml", "law.csv", "mould.csv"):
        with page.expect_download():
            page.locator(f'[data-take="{name}"]').click()
    page.get_by_role("tab", name="Specification").click()
    visit.at_rest()
