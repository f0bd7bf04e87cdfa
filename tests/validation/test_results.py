"""Claims evaluated in processes: the same numbers as in one, and errors that are failed checks."""

from functools import partial

import pytest
from click.testing import CliRunner

from metafem.drawing import new_figure
from validation import results
from validation.__main__ import main
from validation.check import Claim, Picture
from validation.paper import bounds
from validation.results import collected, evaluated, selected


@pytest.mark.slow
def test_two_processes_give_the_results_of_one():
    names = ["bounds", "table_s1", "one_contact"]
    told = []
    found = collected(names, 2, told.append)
    assert list(found) == names
    assert sorted(each.name for each in told) == sorted(names)
    assert found == collected(names, 1)


def test_a_figure_that_raises_is_a_failed_check(monkeypatch):
    def good(width):
        """Empty, {width:g} inches wide."""
        return new_figure(width, 2.0)

    figures = {"good": Picture(partial(good, 3.0), {"width": 3.0}), "bad": Picture(lambda: 1 / 0)}
    monkeypatch.setattr(bounds, "claim", lambda: Claim("Bounds", [], figures))
    monkeypatch.setattr(results, "evaluate", results.evaluate.__wrapped__)
    found = evaluated("bounds")
    assert [figure.caption for figure in found.figures] == ["Empty, 3 inches wide."]
    (check,) = found.failed
    assert check.name == "figure 'bad' ran into: ZeroDivisionError: division by zero"


def test_quick_leaves_out_what_takes_long():
    wanted, left_out = selected(("paper", "fe_hertz"), quick=True)
    assert "fe_hertz" in left_out
    assert "bounds" in wanted
    assert not set(wanted) & set(left_out)
    assert selected(("fe_hertz",)) == (["fe_hertz"], [])


def test_a_failed_check_is_printed_and_ends_with_one(monkeypatch, tmp_path):
    monkeypatch.setattr(bounds, "claim", lambda: 1 / 0)
    monkeypatch.setattr(results, "evaluate", results.evaluate.__wrapped__)
    done = CliRunner().invoke(main, ["bounds", "-o", str(tmp_path / "site")])
    assert done.exit_code == 1
    assert "failed: bounds: ran into: ZeroDivisionError: division by zero: computed none" in done.output
    assert "0 of 1 checks passed" in done.output
    assert (tmp_path / "site" / "paper.html").exists()
    refused = CliRunner().invoke(main, ["--readme", "--quick"])
    assert refused.exit_code == 2
    assert "--readme needs all claims" in refused.output
