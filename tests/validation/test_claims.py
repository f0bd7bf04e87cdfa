"""Quick claims hold, each check names its source, and errors are failed checks."""

from runpy import run_path

import pytest
from click.testing import CliRunner

from metafem.drawing import new_figure
from validation import results
from validation.__main__ import main
from validation.chapters import CHAPTERS, FOLDER
from validation.check import Claim, Picture
from validation.paper import bounds
from validation.results import evaluate, evaluated
from validation.sources import printed

# Claims of less than half a second; `python -m validation` evaluates all.
QUICK = (
    *("bounds", "contact_calibration", "equations"),
    *("fig1_flow", "fig2_calibration", "fig3_branches", "fig3_operating_points", "fig4_linear"),
    *("fig5_bilinear", "one_contact", "order3_equations"),
    *("plasticity", "table_s1", "table_s2"),
)


def test_quick_claims_hold_and_check_each_printed_number_once():
    found = [evaluate(name) for name in QUICK]
    assert [check.name for claim in found for check in claim.checks if not check.passed] == []
    sources = [check.source for claim in found for check in claim.checks if check.source.quantity]
    assert len({(source.text, source.quantity) for source in sources}) == len(sources) > 15
    assert all(source.link.endswith("science.adk4234") for source in sources)
    with pytest.raises(ValueError, match="must begin with"):
        printed("somewhere")


def test_each_claim_is_in_one_chapter_and_is_short():
    found = {path.stem: path.read_text("utf-8") for path in FOLDER.glob("*/*.py")}
    found = {name: text for name, text in found.items() if "\ndef claim(" in text}
    assert sorted(name for chapter in CHAPTERS for name in chapter.claims) == sorted(found)
    lines = run_path(str(FOLDER.parent / ".ci" / "count.py"))["python"]
    assert [name for name, text in found.items() if lines(text)[0] > 100] == []
    assert CliRunner().invoke(main, ["nothing"]).exit_code == 2


def test_a_claim_or_a_figure_that_raises_is_a_failed_check_and_ends_with_one(monkeypatch, tmp_path):
    monkeypatch.setattr(results, "evaluate", results.evaluate.__wrapped__)
    figures = {"good": Picture(lambda: new_figure(3.0, 2.0)), "bad": Picture(lambda: 1 / 0)}
    monkeypatch.setattr(bounds, "claim", lambda: Claim("Bounds", [], figures))
    assert ["'bad'" in check.name for check in evaluated("bounds").failed] == [True]
    monkeypatch.setattr(bounds, "claim", lambda: 1 / 0)
    done = CliRunner().invoke(main, ["bounds", "-o", str(tmp_path / "site")])
    assert done.exit_code == 1
    assert "0 of 1 checks passed" in done.output
    assert (tmp_path / "site" / "paper.html").exists()
    assert CliRunner().invoke(main, ["--readme", "--quick"]).exit_code == 2
