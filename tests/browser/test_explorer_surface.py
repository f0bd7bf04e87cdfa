"""The surface of the explorer in a browser: kept heights and empty sites, by mouse and by keys."""

import re

import pytest

from metafem.explorer.surface_data import asked_sites
from metafem.files import parsed
from tests.browser.hands import after


def site(visit, number):
    return visit.page.locator(f'[data-site="{number}"]')


def menu(visit, action):
    return visit.page.locator(f'.menu [data-action="{action}"]')


def sites_after(visit, step):
    """Do a step and wait for its answer, and until the map has its place: other lines of text move it."""
    after(visit, step)
    visit.at_rest()
    return asked_sites(visit.text)


def heights(visit):
    """Return heights [um] by site of the design of the text that is shown, as the command finds them."""
    design = parsed(visit.text, {}).design()
    return dict(zip(design.sites.tolist(), 1e3 * design.surface.height, strict=True))


def test_a_height_is_kept_by_a_click_and_released_by_undo(visit):
    site(visit, 20).click()
    shown = float(re.search(r"[\d.]+(?= µm)", menu(visit, "pin").inner_text())[0])
    asked = sites_after(visit, menu(visit, "pin").click)
    assert asked.pinned == {20: f"{shown} um"}
    assert heights(visit)[20] == pytest.approx(shown, rel=1e-12)
    assert "pinned" in site(visit, 20).get_attribute("class")
    assert sites_after(visit, visit.page.get_by_role("button", name="Undo").click).pinned == {}
    assert "pinned" not in site(visit, 20).get_attribute("class")


def test_a_typed_height_and_an_empty_site(visit):
    site(visit, 9).click()
    visit.page.get_by_label("Height in micrometres").fill("120.5")
    assert sites_after(visit, menu(visit, "type").click).pinned == {9: "120.5 um"}
    site(visit, 10).click()
    assert sites_after(visit, menu(visit, "empty").click).empty == {10}
    assert "empty" in site(visit, 10).get_attribute("class").split()
    found = heights(visit)
    assert 10 not in found
    assert found[9] == pytest.approx(120.5, rel=1e-12)
    site(visit, 10).click()
    assert sites_after(visit, menu(visit, "release").click).empty == set()


def test_a_rectangle_and_further_clicks_select_several(visit):
    first, last = (site(visit, number).bounding_box() for number in (8, 17))
    mouse = visit.page.mouse
    mouse.move(first["x"] - 1, first["y"] + first["height"] + 1)
    mouse.down()
    mouse.move(last["x"] + last["width"], last["y"], steps=3)
    mouse.up()
    assert visit.page.locator(".menu b").inner_text() == "4 sites"
    site(visit, 18).click(modifiers=["Shift"])
    site(visit, 8).click(modifiers=["Shift"])
    assert sites_after(visit, menu(visit, "empty").click).empty == {9, 16, 17, 18}


def test_the_colours_say_what_they_mean(visit):
    for what, words in (("pressure", "mean contact pressure [MPa]"), ("sensitivity", "[%/µm]")):
        visit.page.get_by_label("Colour of the sites").select_option(what)
        visit.page.locator(".surface-view .axes text").filter(has_text=words).wait_for()
    site(visit, 20).hover()
    assert "of friction per µm" in visit.page.locator(".tip").inner_text()


def test_without_webgl_the_map_stays(visit):
    # the browser of the tests has neither a graphics card nor one in software
    visit.page.evaluate("() => { HTMLCanvasElement.prototype.getContext = () => null; }")
    visit.page.get_by_role("tab", name="3D").click()
    visit.page.get_by_text("This browser has no WebGL").wait_for()
    visit.errors.clear()  # three.js reports what it could not make
    visit.page.get_by_role("tab", name="Map").click()
    assert site(visit, 20).is_visible()
