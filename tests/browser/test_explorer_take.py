"""The figure for a paper, in a browser."""

import io
import re
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


def test_a_figure_for_a_paper_has_the_size_of_its_fields_and_a_wrong_size_is_named(visit):
    page = visit.page
    page.get_by_role("tab", name="Take it").click()
    button = page.locator('[data-take="figure.zip"]')
    width = page.get_by_label("Width [mm]")
    width.fill("wide")
    width.blur()
    button.click()
    page.get_by_text("figure.zip was not downloaded: width = wide must be a number of millimetres").wait_for()
    width.fill("85")
    width.blur()
    with page.expect_download() as download:
        button.click()
    read = zipfile.ZipFile(io.BytesIO(Path(download.value.path()).read_bytes()))
    assert read.namelist() == ["figure.svg", "caption.txt", "law.csv", "heights.csv"]
    points = float(re.search(r'<svg [^>]*?width="(\S+)pt"', read.read("figure.svg").decode("utf-8"))[1])
    assert points * 25.4 / 72 == pytest.approx(85)
