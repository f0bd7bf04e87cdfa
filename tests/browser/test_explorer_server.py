"""The explorer's server: stopped while its page is open, started again, and asked by others."""

import signal

from metafem.files import demo_text
from tests.browser.hands import after
from validation.scenes.explorer import PATIENCE, served, visited


def test_a_page_outlives_its_server(browser):
    with served() as first, visited(browser, first) as visit:
        port = first.origin.rpartition(":")[2].strip("/")
        visit.drag("point-1", 12, -20)
        text = visit.text
        first.process.send_signal(signal.SIGINT)
        assert first.process.wait(PATIENCE) == 0
        lost = visit.page.get_by_text("Connection lost")
        lost.wait_for(timeout=1e3 * PATIENCE)
        with served(None, "--port", port) as second:
            assert second.address == first.address
            visit.page.wait_for_event("load", timeout=1e3 * PATIENCE)
            visit.settled()
            assert visit.text == text
            assert not lost.is_visible()
            visit.entered("limits.max_height", "280 um")
            visit.page.reload()
            visit.settled()
            assert 'max_height = "280 um"' in visit.text
            for _ in range(2):
                after(visit, visit.page.get_by_role("button", name="Undo").click)
            assert visit.text == demo_text("operating-points")
            assert second.said == ""
        assert second.process.returncode == 143
