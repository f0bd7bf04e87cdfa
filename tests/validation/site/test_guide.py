"""The pages of the guide link each other, and lose no link that the site can follow."""

import re
from html import unescape

import pytest

from validation.site.guide import FOLDER, ORDER, anchor, guide


def test_every_file_is_a_page():
    assert sorted(ORDER) == sorted(path.stem for path in FOLDER.glob("*.md"))


@pytest.mark.parametrize("page", guide(), ids=ORDER)
def test_links_lead_to_pages_of_the_site(page):
    local = [href for href in re.findall(r'href="([^"]+)"', page.body) if not href.startswith("https:")]
    pages = {f"{name}.html" for name in ORDER} | {"../cost.html"}
    assert {href.partition("#")[0] for href in local if not href.startswith("#")} <= pages
    assert page.title
    assert "<h1" not in page.body


@pytest.mark.parametrize("page", guide(), ids=ORDER)
def test_headings_have_anchors(page):
    for place, words in re.findall(r'<h2 id="([^"]+)">(.*?)</h2>', page.body):
        assert place == anchor(re.sub(r"<[^>]+>", "", unescape(words)))
    assert page.body.count("<h2") == len(re.findall(r'<h2 id="', page.body))
