"""The explorer's server: stopped while its page is open, started again, and asked by others."""

import signal

import pytest

from metafem.files import demo_text
from tests.browser.hands import after, hold
from validation.scenes.explorer import PATIENCE, served, visited


def test_a_page_outlives_its_server(browser):
    with served() as first, visited(browser, first) as visit:
        port = first.origin.rpartition(":")[2].strip("/")
        visit.drag("point-1", 12, -20)
        text = visit.text
        first.process.send_signal(signal.SIGINT)
        assert first.process.wait(PATIENCE) == 0
        lost = visit.page.get_by_role("alert").filter(has_text="The connection to the server is lost")
        lost.wait_for(timeout=1e3 * PATIENCE)
        assert visit.page.locator(".bar .chip").inner_text() == "no server: changes must wait"
        assert visit.page.locator(".explorer").get_attribute("inert") is not None
        assert visit.page.get_by_label("Model").first.is_disabled()
        with served(None, "--port", port) as second:
            assert second.address == first.address
            visit.page.wait_for_event("load", timeout=1e3 * PATIENCE)
            visit.settled()
            assert visit.text == text
            assert not lost.is_visible()
            after(visit, visit.page.get_by_role("button", name="Undo").click)
            assert visit.text == demo_text("operating-points")
            assert second.said == ""
        assert second.process.returncode == 143


def test_a_drag_that_a_stopped_server_did_not_take_is_made_by_the_next_one(browser):
    with served() as first, visited(browser, first) as visit:
        port = first.origin.rpartition(":")[2].strip("/")
        x, y = hold(visit, "point-1")
        visit.page.mouse.move(x + 12, y - 15, steps=3)
        first.process.send_signal(signal.SIGINT)
        first.process.wait(PATIENCE)
        visit.page.get_by_text("it is made when the connection is back").wait_for(timeout=1e3 * PATIENCE)
        assert visit.middle("point-1") == pytest.approx((x, y), abs=1)
        visit.page.mouse.up()
        assert visit.text == demo_text("operating-points")
        with served(None, "--port", port):
            visit.page.wait_for_event("load", timeout=1e3 * PATIENCE)
            visit.page.wait_for_function("() => probe.history().at === 1", timeout=1e3 * PATIENCE)
            visit.settled()
            assert visit.middle("point-1") == pytest.approx((x + 12, y - 15), abs=2)
            assert "1.68" not in visit.text
