"""The written site, and the examples on it."""

import re

import pytest
from matplotlib.figure import Figure

from validation.site.scripts import run, scripts


def test_pages_are_written_and_name_no_machine(whole_site):
    pages = sorted(whole_site.rglob("*.html"))
    assert {"index.html", "paper.html", "e01_hertz.html"} <= {path.name for path in pages}
    assert {"api", "examples", "guide"} <= {path.parent.name for path in pages}
    for path in pages:
        text = path.read_text("utf-8")
        assert not re.search(r"/tmp/|/home/|/root/|0x[0-9a-f]{7,}", text), path
    text = (whole_site / "examples" / "e01_hertz.html").read_text("utf-8")
    assert "contact radius 179.69 µm" in text
    assert "<svg" in text


@pytest.mark.parametrize("script", scripts(), ids=lambda script: script.name)
def test_examples_run_print_assert_a_number_and_draw(script):
    found = run(script)
    assert re.search(r"^ *assert ", script.code, re.MULTILINE)
    assert found.output.count("\n") >= 2
    assert isinstance(found.figure, Figure)
    assert found.figure.axes[0].get_xlabel()
