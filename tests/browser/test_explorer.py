"""The explorer in a browser."""

from validation.scenes.explorer import visited

# Most requests of the first page up to its first law; NiceGUI makes twelve of them itself.
MOST_REQUESTS = 30


def test_the_page_shows_the_first_law_and_asks_no_other_machine(browser, server):
    with visited(browser, server) as visit:
        assert visit.asked == 1
        assert visit.errors == []
        assert len(visit.requests) <= MOST_REQUESTS
        assert [each for each in visit.requests if not each.startswith(server.origin)] == []
    assert server.said == ""
