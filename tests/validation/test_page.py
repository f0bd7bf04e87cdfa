"""The report: what it shows of claims, the same to the byte, and no request to anywhere."""

import json
import re
from dataclasses import replace

import pytest

from metafem.drawing import new_figure
from metafem.drawing.inline import drawn
from validation import verdicts
from validation.chapters import CHAPTERS
from validation.check import Difference, Reason, Table, below, near, reported
from validation.page import readme_table, report
from validation.results import Evaluated
from validation.sources import printed, publication
from validation.verdicts import Evidence, NotEvaluated

LEAST = ["fe_hertz", "least", "scale", "[µm]"]

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
    asked = {
        "question": "Is it so?",
        "page": "finite_elements.html",
        "headline": "Yes",
        "answer": "The scale is {scale} and more.{shown}{absent}",
        "numbers": {"scale": ["fe_hertz", "value", "error"]},
        "parts": {
            "shown": {"shown": ["fe_hertz", "sc"], "text": " At most {low:2}.", "numbers": {"low": LEAST}},
            "absent": {"shown": ["fe_hertz", "nowhere"], "text": "", "otherwise": " Nothing else."},
        },
    }
    monkeypatch.setattr(verdicts, "QUESTIONS", {"asked": asked})


def test_a_table_of_a_claim_is_on_its_page_and_in_the_data(results):
    table = Table("Two cells.", ("a <b>", "c"), {"Few": [("1 %", "none")]})
    pages = report({**results, "fe_hertz": replace(results["fe_hertz"], table=table)})
    page = pages["finite_elements.html"]
    assert "Two cells." in page
    assert "<th>a &lt;b&gt;</th><th>c</th>" in page
    assert (
        '<tr><th colspan="2">Few</th></tr>\n<tr><td class="value">1 %</td><td class="value">none</td></tr>'
        in page
    )
    data = json.loads(pages["results.json"])["claims"]
    assert data["fe_hertz"]["table"]["parts"] == {"Few": [["1 %", "none"]]}
    assert "table" not in data["fig4_linear"]


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


def test_the_answer_on_the_paper_counts_what_is_reproduced_and_what_is_not(results):
    numbers = (printed("Table S1", "numbers of asperities", 3), printed("Fig. 4 caption", "measured slope"))
    checks = tuple(near("number", 7.0, 7.0, 0.0, source) for source in numbers)
    results["table_s1"] = replace(results["fig4_linear"], name="table_s1", rows=checks)
    known = {"first": 241.0, "second": 170.0, "third": 107.0, "red": 26.0, "blue": 5.0}
    found = verdicts.FOLLOWING["paper"](Evidence(results), known)
    assert [found[key] for key in ("printed", "tables", "outside", "heights", "differing")] == [
        4,
        3,
        31,
        128,
        2,
    ]
    assert (found["measured"], found["apart"]) == ("0.098 ± 0.005", "2.6, 2.6 and 8.2")
    assert found["left_out"].startswith(" 14 of 16 claims were left out")
    index = report(results)["index.html"]
    assert "listed as 2 differences</a>" in index
    assert "2 numbers or statements printed in the paper are not reproduced" in index
    assert "4 distinct numbers printed in the paper" in index


def test_what_is_not_reproduced_is_listed_by_reason(results):
    row = Difference("slope", 7.0, "5", "The data say 7.", printed("Fig. 5 caption"), Reason.MEASURED)
    results["fig4_linear"] = replace(results["fig4_linear"], rows=(*ROWS, row))
    index = report(results)["index.html"]
    listed = index[index.index('id="differences"') :]
    measured, contradicted = (
        listed.index(f"<h3>{why.value}") for why in (Reason.MEASURED, Reason.CONTRADICTED)
    )
    assert (
        measured < listed.index("The data say 7.") < contradicted < listed.index("The integers add up to 65.")
    )
    assert Reason.MISPRINTED.value not in listed


def test_a_chapter_begins_with_a_table_of_its_claims_and_folds_the_rest(results):
    text = report(results)["paper.html"]
    table, rest = text.split('<table class="summary">')[1].split("</table>", 1)
    assert "Fig. 4: two linear laws of one material pair." in table
    assert '<td class="value">2 of 2</td>' in table
    assert 'slope &lt;m&gt;: <a href="#fig4_linear-slope-m">6.9</a>, expected 6.87 ± 0.05' in table
    for title, row in (("Checks", "slope"), ("Identities", "error"), ("Results", "scale")):
        folded = rest.split(f"<details>\n<summary><h3>{title}</h3>")[1].split("</details>")[0]
        assert f'<td class="name">{row}' in folded
    bad = {**results, "fig4_linear": replace(results["fig4_linear"], rows=(replace(ROWS[0], passed=False),))}
    assert "<details open>" in report(bad)["paper.html"]


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


def test_verdicts_say_what_is_absent_and_refuse_rows_that_do_not_exist(results, monkeypatch):
    assert readme_table(results).splitlines()[2].endswith("1.0 × 10⁻¹² and more. At most 20. Nothing else. |")
    (found,) = verdicts.verdicts(results)
    assert (found.state, found.link) == ("holds", "finite_elements.html#fe_hertz-error")
    (absent,) = verdicts.verdicts({"fig4_linear": results["fig4_linear"]})
    assert (absent.state, absent.link) == ("absent", "")
    assert "The claim fe_hertz was left out of this run" in absent.sentence
    # what ran of the chapter is the answer
    monkeypatch.setitem(verdicts.QUESTIONS["asked"], "page", "paper.html")
    (part,) = verdicts.verdicts({"fig4_linear": results["fig4_linear"]})
    assert (part.headline, part.state) == ("In part: 2 of 2 checks passed", "absent")
    assert part.link == "paper.html"
    assert (
        f"1 of {len(CHAPTERS[0].claims)} claims ran, with their numbers of checks: Fig. 4 (2)."
        in part.sentence
    )
    bad = replace(results["fig4_linear"], rows=(replace(ROWS[0], passed=False),))
    (failed,) = verdicts.verdicts({"fig4_linear": bad})
    assert (failed.headline, failed.state) == ("1 check failed", "failed")
    evidence = Evidence(results)
    assert evidence.number("fig4_linear", "largest", "scale") == 40.083
    assert evidence.number("fig4_linear", "least", "sc", "[µm]") == 20.015
    with pytest.raises(
        LookupError, match=r"fig4_linear has no row named 'slope'; .* Its rows: slope <m>; error"
    ):
        evidence.value("fig4_linear", "slope")
    with pytest.raises(NotEvaluated):
        evidence.claim("bounds")
