"""The pages of the report: the questions with their numbers, and one page for each chapter."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from metafem.report.html import render
from validation.chapters import CHAPTERS, Chapter, first_line
from validation.check import Claim, Reason
from validation.numbers import computed, expected, number, powers
from validation.published import REFERENCE
from validation.questions import questions
from validation.sources import Kind

Results = Mapping[str, Claim]

TEMPLATES = Path(__file__).parent / "templates"

FORMATS = {"computed": computed, "expected": expected, "number": number, "powers": powers}

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


def write_report(folder: Path, results: Results, left_out: Sequence[str] = ()) -> None:
    """Write the pages and results.json into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    chapters = {each: [results[name] for name in each.claims if name in results] for each in CHAPTERS}
    pages = {"index.html": _index(results, chapters, left_out)}
    for chapter, found in chapters.items():
        pages[f"{chapter.name}.html"] = _page(
            "chapter.html",
            f"{chapter.name}.html",
            chapter=chapter,
            results=found,
            checks=[check for each in found for check in each.checks],
            left_out=[name for name in chapter.claims if name not in results],
            compared={each.name: first_line(each.name) for each in found},
        )
    claims = [asdict(replace(each, drawn=())) for each in results.values()]
    data = {"left_out": list(left_out), "claims": claims}
    pages["results.json"] = json.dumps(data, indent=1, ensure_ascii=False, default=lambda kind: kind.value)
    for name, text in pages.items():
        (folder / name).write_text(text, "utf-8")


def _page(template: str, here: str, **values: Any) -> str:
    """Return a page of the report, with the bar that leads to the others."""
    bar = [(f"{chapter.name}.html", chapter.name.replace("_", " ").capitalize()) for chapter in CHAPTERS]
    return render(template, TEMPLATES, here=here, bar=bar, formats=FORMATS, **values)


def _index(results: Results, chapters: Mapping[Chapter, list[Claim]], left_out: Sequence[str]) -> str:
    checks = [check for each in results.values() for check in each.checks]
    differing = [row for each in results.values() for row in each.differences]
    kinds = Counter(check.source.kind for check in checks)
    return _page(
        "index.html",
        "index.html",
        checks=checks,
        total=len(results),
        questions=questions(results),
        chapters=chapters,
        differing={why.value: rows for why in Reason if (rows := [d for d in differing if d.reason is why])},
        statements=len(differing),
        kinds=[(kind.value, kinds[kind], words) for kind, words in MEANINGS.items()],
        left_out=left_out,
        reference=REFERENCE,
    )
