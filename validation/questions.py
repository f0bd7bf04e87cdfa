"""The questions of the first screen, each with a table of numbers that this run has computed."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from validation.check import Claim, Result
from validation.numbers import computed, expected, powers
from validation.published import paper
from validation.scenes.models import AREA_ERROR, CAP_ERROR, FEW_ERROR
from validation.scenes.random_contacts import CROWDING, LAYER, WIDTH

# The largest errors and the ranges that the documentation states, beside the numbers of the paper.
ERRORS = {"area_error": AREA_ERROR, "cap_error": CAP_ERROR, "few_error": FEW_ERROR}
STATED = ERRORS | {"width": WIDTH, "crowding": CROWDING, "layer": LAYER}


def questions(results: Mapping[str, Claim]) -> list[dict[str, Any]]:
    """Return the questions of the file, each with its numbers of this run and the failed checks behind them.

    A number is a quantity, what is stated of it, what was computed, and the files that compute it. Numbers of
    a claim that was not evaluated are left out.
    """
    text = Path(__file__).with_suffix(".toml").read_text("utf-8")
    found = tomllib.loads(text)["question"]
    for each in found:
        each["numbers"] = [
            row for row in each["numbers"] if all(claim in results for claim, *_ in row["rows"])
        ]
        each["found"] = each["found"].format(**STATED)
        claims = dict.fromkeys(claim for row in each["numbers"] for claim, *_ in row["rows"])
        each["failed"] = [check for claim in claims for check in results[claim].failed]
        for row in each["numbers"]:
            values = [value(results[claim], words) for claim, *rows in row["rows"] for words in rows]
            row["files"] = [results[claim].file for claim, *_ in row["rows"]]
            row["stated"] = _spaced(row.get("stated", "–").format(**paper(), **STATED))
            row["computed"] = powers(_spaced(row["metafem"].format(*values)))
    return found


def _spaced(text: str) -> str:
    """Return a text whose percent signs stay with their numbers."""
    return text.replace(" %", "%").replace("%", "\N{NO-BREAK SPACE}%")


def value(claim: Claim, words: Sequence[str]) -> float:
    """Return the number of the row of a name, or the largest in size of the rows that contain some words."""
    named = [row for row in claim.rows if [row.name] == words]
    rows = named or [row for row in claim.rows if all(word in row.name for word in words)]
    if not rows and not claim.failed:
        names = "; ".join(row.name for row in claim.rows)
        raise LookupError(f"{claim.name} has no row {words}, which questions.toml reads; its rows: {names}")
    sizes = [row.value if isinstance(row, Result) else row.computed for row in rows]
    return max(sizes, key=abs, default=float("nan"))


def markdown(results: Mapping[str, Claim]) -> str:
    """Return the questions in Markdown, a section for each."""
    return "\n\n".join(_section(each) for each in questions(results)).replace("E*", r"E\*")


def _section(of: dict[str, Any]) -> str:
    lines = [f"### {of['title']}", "", of["found"]]
    for check in of["failed"]:
        words = f"{check.name}: computed {computed(check)}, expected {expected(check)}"
        lines += ["", f"**A check behind these numbers failed**: {words}."]
    lines += ["", "| | stated | metafem | computed by |", "|---|---|---|---|"]
    for row in of["numbers"]:
        files = ", ".join(f"[{Path(name).stem}](../../{name})" for name in row["files"])
        lines.append(f"| {row['what']} | {row['stated']} | {row['computed']} | {files} |")
    return "\n".join(lines)
