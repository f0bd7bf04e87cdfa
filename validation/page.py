"""The pages of the report: the questions with their numbers, and one page for each chapter."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from metafem.report.html import render
from validation.chapters import CHAPTERS, Chapter, first_line
from validation.check import Check, Reason
from validation.numbers import cited, computed, expected, number, powers
from validation.published import REFERENCE
from validation.questions import questions
from validation.results import Evaluated, as_data, as_json
from validation.sources import Kind

Results = Mapping[str, Evaluated]

TEMPLATES = Path(__file__).parent / "templates"

FORMATS = {"cited": cited, "computed": computed, "expected": expected, "number": number, "powers": powers}

# What the kinds of source mean to a reader.
MEANINGS = {
    Kind.PAPER: "The number, bound or rule stands in the paper or its Supplementary Materials; the tolerance "
    "of a check need not.",
    Kind.PUBLICATION: "The number or equation stands in another publication, which is linked.",
    Kind.CLOSED_FORM: "A formula of metafem.reference gives the number; no solver uses these formulas.",
    Kind.SECOND_METHOD: "Another method, without the models of metafem, computes it in the same run.",
    Kind.SELF_CONSISTENCY: "Another model or method of metafem gives the number, or its own equations do.",
    Kind.KNOWN_INPUT: "No computation is needed: the true value of synthetic data, a target, an identity.",
}


def report(results: Results, left_out: Sequence[str] = ()) -> dict[str, str]:
    """Return names and texts of the pages and of results.json."""
    pages = {"index.html": _index(results, left_out)}
    for chapter in CHAPTERS:
        pages[f"{chapter.name}.html"] = _chapter(chapter, results)
    pages["results.json"] = as_json({"left_out": list(left_out), **as_data(dict(results))})
    return pages


def write_report(folder: Path, results: Results, left_out: Sequence[str] = ()) -> None:
    """Write the pages and results.json into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in report(results, left_out).items():
        (folder / name).write_text(text, "utf-8")


def _page(template: str, here: str, **values: Any) -> str:
    """Return a page of the report, with the bar that leads to the others."""
    bar = [(f"{chapter.name}.html", chapter.name.replace("_", " ").capitalize()) for chapter in CHAPTERS]
    return render(template, TEMPLATES, here=here, bar=bar, formats=FORMATS, **values)


def _index(results: Results, left_out: Sequence[str]) -> str:
    found = [(chapter, _of(chapter, results)) for chapter in CHAPTERS]
    checks = [check for each in results.values() for check in each.checks]
    differing = [row for each in results.values() for row in each.differences]
    kinds = Counter(check.source.kind for check in checks)
    return _page(
        "index.html",
        "index.html",
        checks=checks,
        total=len(results),
        questions=questions(results),
        chapters=[part for part in found if part[1]],
        differing={why.value: rows for why in Reason if (rows := [d for d in differing if d.reason is why])},
        statements=len(differing),
        failed=[each for each in _addressed(results) if not each[2].passed],
        kinds=[(kind.value, kinds[kind], words) for kind, words in MEANINGS.items()],
        left_out=left_out,
        reference=REFERENCE,
    )


def _chapter(chapter: Chapter, results: Results) -> str:
    found = _of(chapter, results)
    return _page(
        "chapter.html",
        f"{chapter.name}.html",
        chapter=chapter,
        results=found,
        checks=[check for each in found for check in each.checks],
        left_out=[name for name in chapter.claims if name not in results],
        compared={each.name: first_line(each.name) for each in found},
    )


def _addressed(results: Results) -> list[tuple[str, Evaluated, Check]]:
    """Return the checks with their addresses and claims, in the order of the chapters."""
    return [
        (f"{chapter.name}.html#{anchor}", each, row)
        for chapter in CHAPTERS
        for each in _of(chapter, results)
        for anchor, row in each.anchored
        if isinstance(row, Check)
    ]


def _of(chapter: Chapter, results: Results) -> list[Evaluated]:
    return [results[name] for name in chapter.claims if name in results]
