"""The pages of the report: the verdicts, and one page for each chapter."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from validation.chapters import CHAPTERS, Chapter
from validation.check import Check, Difference, Reason, Result
from validation.cited import cited
from validation.discovery import first_line
from validation.numbers import computed, expected, number, powers
from validation.pages import site_page
from validation.published import REFERENCE
from validation.results import Evaluated, as_data, as_json, module_of
from validation.sources import Kind
from validation.verdicts import verdicts

Results = Mapping[str, Evaluated]

FORMATS = {"cited": cited, "computed": computed, "expected": expected, "number": number, "powers": powers}

# So many claims of a chapter show their first figure; the others fold it, which keeps the page below
# 20,000 px on a phone.
PICTURED = 12

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


def report(results: Results, left_out: Sequence[str] = (), *, whole: bool = False) -> dict[str, str]:
    """Return names and texts of the pages and of results.json."""
    pages = {"index.html": _index(results, left_out, whole)}
    for chapter in CHAPTERS:
        pages[f"{chapter.name}.html"] = _chapter(chapter, results, left_out, whole)
    data = {
        "verdicts": [asdict(each) for each in verdicts(results)],
        "left_out": list(left_out),
        "printed_numbers": [
            {"row": where, "place": check.source.text, "quantity": check.source.quantity}
            for where, check in _printed(results)
        ],
        **as_data(dict(results)),
    }
    pages["results.json"] = as_json(data)
    return pages


def write_report(
    folder: Path, results: Results, left_out: Sequence[str] = (), *, whole: bool = False
) -> None:
    """Write the pages and results.json into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in report(results, left_out, whole=whole).items():
        (folder / name).write_text(text, "utf-8")


def answers(results: Results) -> str:
    """Return the verdicts in Markdown, a section for each question."""
    sections = [f"### {each.question}\n\n**{each.headline}.** {each.sentence}" for each in verdicts(results)]
    return "\n\n".join(sections).replace("E*", r"E\*")


def _index(results: Results, left_out: Sequence[str], whole: bool) -> str:
    checks = [check for each in results.values() for check in each.checks]
    chapters = [
        (chapter, _of(chapter, results), [name for name in chapter.claims if name in left_out])
        for chapter in CHAPTERS
    ]
    shown = [part for part in chapters if part[1] or part[2]]
    groups = [
        group
        for chapter, found, _ in shown
        for each in found
        for group in _grouped(each, f"{chapter.name}.html#{each.name}")
    ]
    differing = {why.value: listed for why in Reason if (listed := [g for g in groups if g.reason is why])}
    failed = [found for found in _addressed(results) if not found[2].passed]
    kinds = Counter(check.source.kind for check in checks)
    return site_page(
        "index.html",
        here="index.html",
        whole=whole,
        checks=checks,
        total=len(results),
        verdicts=verdicts(results),
        chapters=shown,
        differing=differing,
        statements=sum(len(each.differences) for each in results.values()),
        printed=_printed(results),
        failed=failed,
        kinds=[(kind.value, kinds[kind], words) for kind, words in MEANINGS.items()],
        left_out=_described(left_out),
        reference=REFERENCE,
        formats=FORMATS,
    )


def _chapter(chapter: Chapter, results: Results, left_out: Sequence[str], whole: bool) -> str:
    found = _of(chapter, results)
    return site_page(
        "chapter.html",
        here=f"{chapter.name}.html",
        whole=whole,
        chapter=chapter,
        results=found,
        checks=[check for each in found for check in each.checks],
        differing=sum(len(each.differences) for each in found),
        left_out=_described([name for name in chapter.claims if name not in results]),
        compared={each.name: first_line(module_of(each.name)) for each in found},
        pictured=PICTURED,
        grouped=_grouped,
        row_types={"check": Check, "result": Result},
        formats=FORMATS,
    )


def _addressed(results: Results) -> list[tuple[str, Evaluated, Check]]:
    """Return the checks with their addresses and claims, in the order of the chapters."""
    return [
        (f"{chapter.name}.html#{anchor}", each, row)
        for chapter in CHAPTERS
        for each in _of(chapter, results)
        for anchor, row in each.anchored(Check)
    ]


def _printed(results: Results) -> list[tuple[str, Check]]:
    """Return the checks of printed numbers with their addresses."""
    return [(where, check) for where, _, check in _addressed(results) if check.source.quantity]


@dataclass(frozen=True)
class Statements:
    """Statements of the paper that do not hold for one reason, with anchors, and where they are shown."""

    title: str
    where: str
    rows: list[tuple[str, Difference]]

    @property
    def reason(self) -> Reason:
        """Why they do not hold."""
        return self.rows[0][1].reason


def _grouped(each: Evaluated, where: str = "") -> list[Statements]:
    """Return the differences of a claim, those with the same words together."""
    groups: dict[str, list[tuple[str, Difference]]] = {}
    for anchor, row in each.anchored(Difference):
        groups.setdefault(row.words, []).append((anchor, row))
    return [Statements(each.title, where, rows) for rows in groups.values()]


def _of(chapter: Chapter, results: Results) -> list[Evaluated]:
    return [results[name] for name in chapter.claims if name in results]


def _described(names: Sequence[str]) -> list[tuple[str, str]]:
    """Return names of claims with the first lines of their documentation."""
    return [(name, first_line(module_of(name))) for name in names]
