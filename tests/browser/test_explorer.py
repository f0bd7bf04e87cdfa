"""The explorer in a browser."""

import pytest

from validation.scenes.explorer import visited

pytestmark = pytest.mark.slow


def test_the_page_shows_the_first_law_and_asks_no_other_machine(browser, server):
    with visited(browser, server) as visit:
        assert visit.asked == 1
        assert visit.errors == []
        assert [each for each in visit.requests if not each.startswith(server.origin)] == []
    assert server.said == ""
