"""Docstrings on a page mean what they say."""

import inspect
import re

import pytest

import metafem as mf
from validation.site.docstrings import html, summary


def nowhere(name):
    """No name has an address."""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Load P/E* [mm^2] and w/E* of A*.", "<p>Load P/E* [mm²] and w/E* of A*.</p>"),
        ("*Rescaled* means P/E*.", "<p><em>Rescaled</em> means P/E*.</p>"),
        ("0 < h <= R and h_i, h_j.", "<p>0 &lt; h &lt;= R and h_i, h_j.</p>"),
        ("The line ``F = m P*`` of `law`.", "<p>The line <code>F = m P*</code> of <code>law</code>.</p>"),
        ("``(<R>/<sqrt R>)^2``", "<p><code>(&lt;R&gt;/&lt;sqrt R&gt;)^2</code></p>"),
        ("See doi:10.1126/science.adk4234.", '<p>See <a href="https://doi.org/10.1126/science.adk4234">'
         "doi:10.1126/science.adk4234</a>.</p>"),
        ("(doi:10.1016/0020-7225(65)90019-4)", '<p>(<a href="https://doi.org/10.1016/0020-7225(65)90019-4">'
         "doi:10.1016/0020-7225(65)90019-4</a>)</p>"),
    ],
)  # fmt: skip
def test_docstrings_mean_what_they_say(text, expected):
    assert html(text, nowhere).strip() == expected


def test_sections_of_docstrings_are_lists_and_code():
    text = html(inspect.getdoc(mf.Limits), lambda name: f"#{name}" if name == "InvalidInput" else None)
    assert "<h4>Parameters</h4>" in text
    assert '<li><b>max_height</b> <span class="quiet">float</span><br>Largest h [mm], positive' in text
    assert '<li><b><a href="#InvalidInput">InvalidInput</a></b><br>If a value' in text
    assert re.search(r"<pre>.*gp.*Limits.*max_height", text, re.DOTALL)
    assert summary("A law.\n\nMore.", nowhere) == "A law."
