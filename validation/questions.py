"""The questions of the first screen, each with a table of numbers that this run has computed."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.check import Check, Result
from validation.published import paper
from validation.results import Evaluated
from validation.scenes.models import AREA_ERROR, CAP_ERROR

# The largest errors that the documentation states, beside the numbers of the paper.
STATED = {"area_error": AREA_ERROR, "cap_error": CAP_ERROR}


@dataclass(frozen=True)
class Number:
    """A quantity, what is stated of it, its numbers in this run, and the files that compute them."""

    what: str
    stated: str
    computed: str
    files: tuple[str, ...]


@dataclass(frozen=True)
class Question:
    """A question, what was found, the page of its evidence, its numbers, and the failed checks behind it."""

    title: str
    found: str
    page: str
    numbers: tuple[Number, ...]
    failed: tuple[Check, ...]


def questions(results: Mapping[str, Evaluated]) -> list[Question]:
    """Return the questions; numbers of a claim that was not evaluated are left out."""
    text = Path(__file__).with_suffix(".toml").read_text("utf-8")
    return [_question(each, results) for each in tomllib.loads(text)["question"]]


def _question(of: Mapping[str, Any], results: Mapping[str, Evaluated]) -> Question:
    shown = [each for each in of["numbers"] if all(claim in results for claim, *_ in each["rows"])]
    read = {claim: results[claim] for each in shown for claim, *_ in each["rows"]}
    failed = tuple(check for each in read.values() for check in each.failed)
    numbers = tuple(_number(each, results) for each in shown)
    return Question(of["title"], of["found"], of["page"], numbers, failed)


def _number(of: Mapping[str, Any], results: Mapping[str, Evaluated]) -> Number:
    found = [value(results[claim], words) for claim, *rows in of["rows"] for words in rows]
    stated = of.get("stated", "–").format(**paper(), **STATED)
    files = tuple(results[claim].file for claim, *_ in of["rows"])
    shown = of["metafem"].format(*found)
    return Number(of["what"], stated.replace("%", " %"), shown.replace("%", " %").replace("  %", " %"), files)


def value(claim: Evaluated, words: Sequence[str]) -> float:
    """Return the number of the row of a name, or the largest in size of the rows that contain some words."""
    named = [row for row in claim.rows if [row.name] == words]
    rows = named or [row for row in claim.rows if all(word in row.name for word in words)]
    if not rows and not claim.failed:
        names = "; ".join(row.name for row in claim.rows)
        raise LookupError(f"{claim.name} has no row {words}, which questions.toml reads; its rows: {names}")
    sizes = [row.value if isinstance(row, Result) else row.computed for row in rows]
    return max(sizes, key=abs, default=float("nan"))


def markdown(results: Mapping[str, Evaluated]) -> str:
    """Return the questions in Markdown, a section for each."""
    return "\n\n".join(_section(each) for each in questions(results)).replace("E*", r"E\*")


def _section(of: Question) -> str:
    lines = [f"### {of.title}", "", of.found]
    if of.failed:
        lines += ["", f"**{len(of.failed)} failed checks**, the first: {of.failed[0].name}."]
    lines += ["", "| | stated | metafem | computed by |", "|---|---|---|---|"]
    for each in of.numbers:
        files = ", ".join(f"[{Path(name).stem}](../../{name})" for name in each.files)
        lines.append(f"| {each.what} | {each.stated} | {each.computed} | {files} |")
    return "\n".join(lines)
