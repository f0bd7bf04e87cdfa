"""Sources as HTML: links to names that the reference explains, files of others, and places for breaks."""

import pytest

from validation.cited import IN_CODE, breaking, cited


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("a² = R d <1e-06", "a² = R d &lt;10⁻⁶"),
        (
            "0.5 %, metafem.fe.press",
            '0.5 %, <a href="api/metafem.fe.html#press">metafem.<wbr>fe.<wbr>press</a>',
        ),
        (
            "t, metafem.studies.misalignment.misalignment",
            't, <a href="api/metafem.studies.html#misalignment">metafem.<wbr>studies.<wbr>misalignment</a>',
        ),
        ("sum, validation.cited._shown", "sum, _shown in validation/<wbr>cited.<wbr>py"),
        ("sum, validation.nowhere.f", "sum, validation.<wbr>nowhere.<wbr>f"),
    ],
)
def test_a_site_with_the_reference_links_names_and_says_the_files_of_others(text, html):
    assert cited(text, whole=True) == html
    alone = cited(text, whole=False)
    assert "<a" not in alone


def test_code_may_break_behind_its_signs():
    assert breaking("f(x=1)", IN_CODE) == "f(<wbr>x=<wbr>1)"
