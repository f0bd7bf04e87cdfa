"""The report: what it shows of claims, the same to the byte, and no request to anywhere."""

import json
import re
from dataclasses import replace

import pytest

from metafem.drawing import new_figure
from metafem.drawing.inline import drawn
from validation import verdicts
from validation.chapters import CHAPTERS
from validation.check import Difference, below, near, reported
from validation.page import readme_table, report
from validation.results import Evaluated
from validation.sources import printed, publication
from validation.verdicts import Evidence, NotEvaluated

ROWS = (
    near("slope <m>", 6.9, 6.87, 0.05, printed("Fig. 4 caption")),
    below("error", 1e-12, 1e-9, publication("10.1098/rspa.1971.0141", "eq. 15")),
    reported("scale [µm]", 40.083, "eq. S7"),
    reported("scale [µm]", 20.015, "eq. S7"),
    Difference("count", 65.0, "64", "The integers add up to 65.", printed("Table S1")),
)


@pytest.fixture
def results():
    figure = new_figure(4.0, 3.0)
    figure.add_subplot().plot([0.0, 1.0], [2.0, 3.0])
    picture = drawn(figure, "Fig. 4: law", "The line is the law.")
    of = {"fig4_linear": "Fig. 4", "fe_hertz": "Hertz & elements"}
    return {
        name: Evaluated(name, title, f"validation/{name}.py", "A text.", ROWS, (picture,), 1.0)
        for name, title in of.items()
    }


@pytest.fixture(autouse=True)
def one_question(monkeypatch):
    def answer(evidence):
        return "Yes", f"The scale is {evidence.value('fe_hertz', 'error')} and more."

    asked = (verdicts.Question("Is it so?", answer, "finite_elements.html"),)
    monkeypatch.setattr(verdicts, "QUESTIONS", asked)


def test_there_is_a_page_for_each_chapter_and_the_numbers_beside(results):
    pages = report(results, ["bounds"])
    assert set(pages) == {"index.html", "results.json", *(f"{each.name}.html" for each in CHAPTERS)}
    data = json.loads(pages["results.json"])
    assert data["claims"]["fig4_linear"]["checks"][0] == {
        "name": "slope <m>",
        "computed": 6.9,
        "expected": "6.87 ± 0.05",
        "passed": True,
        "source": {
            "kind": "printed in the paper",
            "text": "Fig. 4 caption",
            "link": "https://doi.org/10.1126/science.adk4234",
        },
    }
    assert data["left_out"] == ["bounds"]
    assert data["seconds"] == {"fig4_linear": 1.0, "fe_hertz": 1.0}


def test_checks_results_and_differences_stand_apart(results):
    text = report(results)["paper.html"]
    for title in ("Checks", "Where the paper does not hold", "Results"):
        assert text.count(f"<h3>{title}</h3>") == 1
    rest, checks = text.split("<h3>Checks</h3>")
    assert "slope &lt;m&gt;" in checks
    assert "The integers add up to 65." in rest
    assert '<a href="https://doi.org/10.1098/rspa.1971.0141">' in checks
    assert "The line is the law." in rest
    assert 'download="fig_4_law.csv"' in rest
    assert text.count("as above") == 1  # the method of the second result


def test_the_answer_on_the_paper_counts_the_differences_that_the_page_lists(results):
    row = reported("largest difference of 64 heights [µm]", 0.1, "a method")
    found = {**results, "table_s2": replace(results["fig4_linear"], name="table_s2", rows=(row,))}
    headline, _ = verdicts._reproduced(Evidence(found))
    assert headline == "Yes, except 2 printed numbers or statements"
    assert "2 numbers or statements printed in the paper differ" in report(found)["index.html"]


def test_equal_results_give_equal_bytes_and_times_show_in_one_place(results):
    later = {name: replace(each, seconds=9.0) for name, each in results.items()}
    first, second = report(results), report(later)
    assert first == report(results)
    assert {name for name in first if first[name] != second[name]} == {"results.json"}
    changed = json.loads(second["results.json"])
    assert {**changed, "seconds": json.loads(first["results.json"])["seconds"]} == json.loads(
        first["results.json"]
    )


def test_pages_ask_for_nothing_and_their_anchors_exist(results):
    pages = report(results, ["bounds"])
    identifiers = {name: re.findall(r'\bid="([^"]+)"', text) for name, text in pages.items()}
    for name, text in pages.items():
        if name == "results.json":
            continue
        sources = re.findall(r"""\b(?:src|srcset|poster|action)="([^"]*)"|url\(([^)]*)\)|@import""", text)
        assert all((first or second).startswith(("data:", "#")) for first, second in sources)
        assert "<script" not in text
        for link in re.findall(r'href="([^"]*)"', text):
            if not link.startswith(("data:", "https://doi.org/")):
                page, _, anchor = link.partition("#")
                assert (page or name) in pages, link
                assert not anchor or anchor in identifiers[page or name], link
        named = [each for each in identifiers[name] if each.startswith(("fig4_linear", "fe_hertz"))]
        assert len(named) == len(set(named))


def test_a_failed_check_is_shown_first_and_fails_its_verdict(results):
    bad = (replace(ROWS[0], computed=float("inf"), passed=False), *ROWS[1:])
    pages = report({**results, "fe_hertz": replace(results["fe_hertz"], rows=bad)})
    index = pages["index.html"]
    assert index.index("Failed checks") < index.index("Is it so?")
    assert "1 check failed" in index
    assert '<tr id="fe_hertz-slope-m" class="no">' in pages["finite_elements.html"]
    assert json.loads(pages["results.json"])["claims"]["fe_hertz"]["checks"][0]["computed"] is None


def test_verdicts_say_what_is_absent_and_refuse_rows_that_do_not_exist(results):
    assert readme_table(results).splitlines()[2].startswith("| Is it so? | **Yes.** The scale is 1e-12")
    (found,) = verdicts.verdicts(results)
    assert (found.state, found.link) == ("holds", "finite_elements.html#fe_hertz-error")
    (absent,) = verdicts.verdicts({"fig4_linear": results["fig4_linear"]})
    assert (absent.state, absent.link) == ("absent", "")
    assert "The claim fe_hertz was left out of this run" in absent.sentence
    evidence = Evidence(results)
    assert evidence.largest("fig4_linear", "scale") == 40.083
    assert evidence.least("fig4_linear", "sc", "[µm]") == 20.015
    with pytest.raises(
        LookupError, match=r"fig4_linear has no row named 'slope'; .* Its rows: slope <m>; error"
    ):
        evidence.value("fig4_linear", "slope")
    with pytest.raises(NotEvaluated):
        evidence.claim("bounds")
