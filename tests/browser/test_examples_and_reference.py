"""The pages of the examples and of the reference in a browser: no error, no request, nothing overflows."""

import pytest

from tests.browser.look import browser, faults
from validation.site import write_site

pytestmark = pytest.mark.slow


def test_pages_open_without_a_fault(tmp_path):
    names = write_site(tmp_path)
    with browser() as started:
        assert [each for name in names for each in faults(started, tmp_path / name)] == []


def test_faults_are_found(tmp_path):
    page = tmp_path / "bad.html"
    page.write_text(
        "<!doctype html><html><head><style>body {color: white; background: white}</style></head><body>"
        '<div style="width: 2000px">wide</div><img src="none.png"><script>nothing()</script></body></html>'
    )
    with browser() as started:
        text = "\n".join(faults(started, page))
    for part in ("wide in 390 px", "missing", "nothing is not defined", "request: file", "title", "colour"):
        assert part in text
