"""The answers of the first screen, and the table of printed numbers, from rows of the claims."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from validation.chapters import CHAPTERS
from validation.check import Result, Row
from validation.fidelity.order3_against_resolved import CROWDED
from validation.inversion.later_targets import RANGE
from validation.numbers import DIGITS, number
from validation.paper.interaction_error import ASSIGNMENTS
from validation.published import paper, table
from validation.results import Evaluated
from validation.scenes.compression_tests import MODULUS
from validation.scenes.models import AREA_ERROR, CAP_ERROR, FEW_ERROR
from validation.scenes.stability_points import COMPARED

MISSING = "{claim} has no row {words} {name!r}; validation/answers.toml reads it. Its rows: {rows}"

QUESTIONS: dict[str, dict[str, Any]] = tomllib.loads(
    Path(__file__).with_name("answers.toml").read_text("utf-8")
)
PRINTED: list[dict[str, Any]] = QUESTIONS.pop("printed")  # type: ignore[assignment]


class Shown(float):
    """A number that is written as the report writes it: to some digits, as a percentage, or "none"."""

    def __format__(self, form: str) -> str:
        if form in ("word", "Word"):
            return number(self) if self else "none" if form == "word" else "None"
        factor = {"%": 1e2, "p": 1e2, "µ": 1e6}.get(form[-1:], 1.0)
        text = number(factor * self, int(form.rstrip("%pµ") or DIGITS))
        return f"{text} %" if form.endswith("%") else text


# What the answers state besides the rows.
CONSTANTS = {
    "assignments": Shown(ASSIGNMENTS),
    "area_error": Shown(AREA_ERROR),
    "few_error": Shown(FEW_ERROR),
    "cap_error": Shown(CAP_ERROR),
    "compared": Shown(COMPARED),
    "crowding": Shown(CROWDED),
    "range": Shown(RANGE[1] / RANGE[0]),
    "within": Shown(paper()["fig5"]["measured_within"]),
}


@dataclass(frozen=True)
class Verdict:
    """A question, the answer in a few words and in one sentence, where its evidence is, and how it went.

    The states are "holds", "partly", "failed" (a check of the evidence failed) and "absent" (a claim that the
    answer needs was not evaluated).
    """

    question: str
    headline: str
    sentence: str
    link: str
    state: str


class NotEvaluated(Exception):
    """A claim that a verdict needs was not evaluated in this run."""


@dataclass
class Evidence:
    """The evaluated claims, which remembers those that were read."""

    results: Mapping[str, Evaluated]
    read: list[str] = field(default_factory=list)
    first: Row | None = None
    partly: bool = False

    def claim(self, name: str) -> Evaluated:
        """Return an evaluated claim."""
        if name not in self.results:
            raise NotEvaluated(name)
        self.read.append(name)
        return self.results[name]

    def chapter(self, name: str) -> list[Evaluated | None]:
        """Return all claims of a chapter; None for one that was not evaluated."""
        names = [each for chapter in CHAPTERS if chapter.name == name for each in chapter.claims]
        return [self.claim(each) if each in self.results else None for each in names]

    def value(self, claim: str, name: str) -> float:
        """Return the computed number of the row of a name."""
        return self._values(claim, "named", name, lambda row: row.name == name)[0]

    def values(self, claim: str, *parts: str) -> list[float]:
        """Return the sizes of the numbers of the rows whose names contain all of some words."""
        wanted = self._values(claim, "with", " … ".join(parts), lambda row: all(p in row.name for p in parts))
        return [*map(abs, wanted)]

    def number(self, claim: str, how: str, *names: str) -> Shown:
        """Return the number that the answers read in a way, by the name of a row or by words of names."""
        if how in ("most", "value"):
            found = [self.value(claim, name) for name in names]
            return Shown(found[0] if how == "value" else max(map(abs, found)))
        return Shown({"largest": max, "least": min}[how](self.values(claim, *names)))

    def has(self, claim: str, words: str) -> bool:
        """Whether a claim was evaluated and the name of one of its rows contains some words."""
        return claim in self.results and any(words in row.name for row in self.claim(claim).rows)

    def link(self, page: str) -> str:
        """Return a page with the anchor of the first row that was read; the page alone without a row."""
        rows = [pair for name in self.read for pair in self.results[name].anchored(Row)]
        return next((f"{page}#{anchor}" for anchor, row in rows if row is self.first), page)

    def _values(self, claim: str, words: str, name: str, wanted: Callable[[Row], bool]) -> list[float]:
        rows = self.claim(claim).rows
        read = [row for row in rows if wanted(row)]
        self.first = self.first or next(iter(read), None)
        found = [row.value if isinstance(row, Result) else row.computed for row in read]
        if not found and not self.claim(claim).failed:
            known = "; ".join(row.name for row in rows)
            raise LookupError(MISSING.format(claim=claim, words=words, name=name, rows=known))
        return found or [float("nan")]


def verdicts(results: Mapping[str, Evaluated]) -> list[Verdict]:
    """Return the answers; one of which claims were not evaluated says which part of them was."""
    return [_verdict(name, Evidence(results)) for name in QUESTIONS]


def _verdict(name: str, evidence: Evidence) -> Verdict:
    question, page = QUESTIONS[name]["question"], QUESTIONS[name]["page"]
    try:
        headline, sentence = answer(name, evidence)
        state = "partly" if evidence.partly else "holds"
    except NotEvaluated as absent:
        headline, sentence = _part(page, evidence, str(absent))
        state = "absent"
    link = evidence.link(page) if evidence.read else ""
    failed = [check for name in dict.fromkeys(evidence.read) for check in evidence.results[name].failed]
    if failed:
        count = f"{len(failed)} check{'s' if len(failed) > 1 else ''} failed"
        return Verdict(question, count, f"The first one: {failed[0].name}.", link, "failed")
    return Verdict(question, headline, sentence, link, state)


def answer(name: str, evidence: Evidence) -> tuple[str, str]:
    """Return the answer to a question in a few words and in a sentence."""
    asked = QUESTIONS[name]
    known: dict[str, Any] = {**CONSTANTS, **_numbers(evidence, asked)}
    for part, of in asked.get("parts", {}).items():
        shown = evidence.has(*of["shown"])
        known[part] = (
            of["text"].format(**known | _numbers(evidence, of)) if shown else of.get("otherwise", "")
        )
    known |= FOLLOWING.get(name, lambda evidence, known: {})(evidence, known)
    return asked["headline"].format(**known), asked["answer"].strip("\n").format(**known)


def _numbers(evidence: Evidence, of: Mapping[str, Any]) -> dict[str, Shown]:
    return {key: evidence.number(*row) for key, row in of.get("numbers", {}).items()}


def _part(page: str, evidence: Evidence, absent: str) -> tuple[str, str]:
    """Return what the claims of the question's page show of which the answer needs an absent one."""
    evidence.first = None  # the evidence is the whole page
    chapter = evidence.chapter(page.removesuffix(".html"))
    found = [each for each in chapter if each is not None]
    left_out = f"The claim {absent} was left out of this run; python -m validation {absent} evaluates it."
    if not found:
        return "Not in this run", left_out
    checks = [check for each in found for check in each.checks]
    passed = sum(check.passed for check in checks)
    ran = "; ".join(f"{each.title} ({len(each.checks)})" for each in found)
    return (
        f"In part: {passed} of {len(checks)} checks passed",
        f"{len(found)} of {len(chapter)} claims ran, with their numbers of checks: {ran}. {left_out}",
    )


def _reproduced(evidence: Evidence, known: Mapping[str, Any]) -> dict[str, Any]:
    """Count printed numbers and differences; the differences are those of all chapters."""
    sources = [check.source for each in evidence.results.values() for check in each.numbers]
    adjusted = zip(("first", "second", "third"), paper()["fig3"]["adjustment_um"], strict=True)
    chapter = evidence.chapter("paper")
    absent = sum(each is None for each in chapter)
    evidence.partly, evidence.first = True, None  # the evidence is the whole page
    return {
        "printed": sum(source.numbers for source in sources),
        "tables": sum(source.numbers for source in sources if source.text.startswith("Table")),
        "outside": Shown(known["red"] + known["blue"]),
        "heights": sum(len(table("table_s2")[colour]) for colour in ("red", "blue")),
        "measured": "{} ± {}".format(*paper()["fig5"]["blue"]["measured_crossover_mm2"]),
        "apart": "{:.1f}, {:.1f} and {:.1f}".format(*(abs(known[key] - each) for key, each in adjusted)),
        "differing": sum(len(each.differences) for each in evidence.results.values()),
        "left_out": f" {absent} of {len(chapter)} claims were left out of this run." if absent else "",
    }


def _interaction(evidence: Evidence, known: Mapping[str, Any]) -> dict[str, Any]:
    names = ("printed", "linear", "relative", "over_rms", "over_largest", "even", "light")
    evidence.partly = (
        max(known[name] for name in names) >= paper()["interaction"]["rms_area_difference_below"]
    )
    partly = "Typically below it on Figs. 4 and 5; on Fig. 3 it depends on the norm and the loads"
    return {"typically": partly if evidence.partly else "Yes"}


def _contacts(evidence: Evidence, known: Mapping[str, Any]) -> dict[str, Any]:
    evidence.partly = known["hertz"] > 1.0 or known["hertz_5"] > 1e2 * known["within"]
    holds = known["hertz"] <= 1.0
    return {"enough": "For the slopes of Fig. 4, yes" if holds else "Not for the slopes of Fig. 4"}


def _cost(evidence: Evidence, known: Mapping[str, Any]) -> dict[str, Any]:
    return {"spread": " to ".join(dict.fromkeys(f"{known[end]:2µ}" for end in ("low", "high")))}


def _fails(evidence: Evidence, known: Mapping[str, Any]) -> dict[str, Any]:
    unsolved = sum(known[name] for name in ("failed", "solver", "search")) - known["inside"]
    return {"unsolved": Shown(unsolved)}


def _measurements(evidence: Evidence, known: Mapping[str, Any]) -> dict[str, Any]:
    return {f"excess_{count}": Shown(known[count] / MODULUS - 1.0) for count in ("one", "five")}


# What follows from several numbers, by the question.
FOLLOWING: dict[str, Callable[[Evidence, Mapping[str, Any]], dict[str, Any]]] = {
    "paper": _reproduced,
    "interaction": _interaction,
    "contacts": _contacts,
    "cost": _cost,
    "fails": _fails,
    "measurements": _measurements,
}


def printed_table(results: Mapping[str, Evaluated]) -> str:
    """Return quantity, printed number and computed number, one line each, in Markdown."""
    lines = ["| quantity | the paper | metafem |", "|---|---|---|"]
    for each in PRINTED:
        computed = each["metafem"].format(*_computed(Evidence(results), each["rows"]))
        words = computed.replace("%", " %").replace("-", "−")
        shown = each["paper"].format(**paper()).replace("%", " %")
        lines.append(f"| {each['quantity']} | {shown} | {words} |")
    return "\n".join(lines)


def _computed(evidence: Evidence, rows: Sequence[Sequence[str]]) -> list[float]:
    return [evidence.value(claim, name) for claim, *names in rows for name in names]
