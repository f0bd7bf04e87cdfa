"""A browser, a server and a page that the tests of this folder share."""

import pytest

from validation.scenes.browser import browser_path, opened
from validation.scenes.explorer import served, visited


@pytest.fixture(scope="package")
def browser():
    """The browser, closed after the last test of this folder: its event loop would disturb others."""
    if browser_path() is None:
        pytest.skip("no chromium is installed")
    with opened() as started:
        yield started


@pytest.fixture(scope="package")
def server():
    """An explorer of the demo."""
    with served() as running:
        yield running


@pytest.fixture(scope="package")
def tab(browser, server):
    """A tab of the explorer: the first page of a browser costs five times as much as the next."""
    with visited(browser, server) as visit:
        yield visit


@pytest.fixture
def visit(tab):
    """The page as at the first visit, which makes no errors."""
    tab.anew()
    yield tab
    assert tab.errors == []
    assert tab.server.said == ""
