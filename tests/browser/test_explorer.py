"""The explorer in a browser."""

import pytest

from validation.scenes.browser import browser_path, opened
from validation.scenes.explorer import served, visited

pytestmark = [
    pytest.mark.skipif(browser_path() is None, reason="no chromium is installed"),
    pytest.mark.slow,
]


@pytest.fixture(scope="module")
def browser():
    """The browser, closed after the tests of this file: its event loop would disturb those of others."""
    with opened() as started:
        yield started


@pytest.fixture(scope="module")
def server():
    """An explorer of the demo."""
    with served() as running:
        yield running


def test_the_page_shows_the_first_law_and_asks_no_other_machine(browser, server):
    with visited(browser, server) as visit:
        assert visit.asked == 1
        assert visit.errors == []
        assert [each for each in visit.requests if not each.startswith(server.origin)] == []
    assert server.said == ""
