"""The answers of the report's first screen: a sentence for each question, with numbers of the claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from validation.chapters import CHAPTERS
from validation.check import Result, Row
from validation.numbers import number
from validation.published import paper
from validation.results import Evaluated
from validation.scenes.compression_tests import MODULUS
from validation.scenes.costs import SCENES

MISSING = "{claim} has no row {words} {name!r}; validation/verdicts.py reads it. Its rows: {rows}"


@dataclass(frozen=True)
class Verdict:
    """A question, the answer in a few words and in one sentence, where its evidence is, and how it went.

    The states are "holds", "partly", "failed" (a check of the evidence failed) and "absent" (not evaluated).
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

    def largest(self, claim: str, *parts: str) -> float:
        """Return the largest size of the numbers of the rows whose names contain all of some words."""
        values = self._values(claim, "with", " … ".join(parts), lambda row: all(p in row.name for p in parts))
        return max(map(abs, values))

    def least(self, claim: str, *parts: str) -> float:
        """Return the smallest size of the same numbers."""
        values = self._values(claim, "with", " … ".join(parts), lambda row: all(p in row.name for p in parts))
        return min(map(abs, values))

    def has(self, claim: str, words: str) -> bool:
        """Whether the name of a row contains some words."""
        return any(words in row.name for row in self.claim(claim).rows)

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


@dataclass(frozen=True)
class Question:
    """A question, its answer in a few words and in a sentence, and the page of the evidence."""

    text: str
    answer: Callable[[Evidence], tuple[str, str]]
    link: str


def verdicts(results: Mapping[str, Evaluated]) -> list[Verdict]:
    """Return the answers; one whose claims were not evaluated says so."""
    return [_verdict(question, Evidence(results)) for question in QUESTIONS]


def _verdict(question: Question, evidence: Evidence) -> Verdict:
    try:
        headline, sentence = question.answer(evidence)
    except NotEvaluated as absent:
        words = f"The claim {absent} was left out of this run; python -m validation evaluates it."
        return Verdict(question.text, "Not in this run", words, "", "absent")
    link = evidence.link(question.link)
    failed = [check for name in dict.fromkeys(evidence.read) for check in evidence.results[name].failed]
    if failed:
        count = f"{len(failed)} check{'s' if len(failed) > 1 else ''} failed"
        return Verdict(question.text, count, f"The first one: {failed[0].name}.", link, "failed")
    return Verdict(question.text, headline, sentence, link, "partly" if evidence.partly else "holds")


def _percent(value: float, digits: int = 2) -> str:
    return f"{number(100.0 * value, digits)} %"


def _reproduced(evidence: Evidence) -> tuple[str, str]:
    heights = evidence.largest("table_s2", "largest difference of 64 heights [µm]")
    chapter = evidence.chapter("paper")
    found = [each for each in chapter if each is not None]
    checks = sum(len(each.checks) for each in found)
    # the differences of all chapters, as the list on the first page counts them
    differing = sum(len(each.differences) for each in evidence.results.values())
    evidence.partly = differing > 0
    absent = len(chapter) - len(found)
    evidence.first = None  # the evidence is the whole page
    return (
        f"Yes, except {differing} printed numbers or statements" if differing else "Yes",
        f"{checks} numbers agree with its figures, tables and equations, or with a second method; the 128 "
        f"heights of Table S2 within {number(heights, 2)} µm."
        + (f" {absent} of {len(chapter)} claims were left out of this run." if absent else ""),
    )


def _interaction(evidence: Evidence) -> tuple[str, str]:
    limit = paper()["interaction"]["rms_area_difference_below"]
    name = "interaction_error"
    points, light, over_rms = (
        evidence.value(name, f"Fig. 3: median rms{reading} of random assignments")
        for reading in ("", " at loads up to 0.35 mm²", " over the rms of A0")
    )
    printed = evidence.largest(name, "Fig. 5", "printed sites: rms")
    linear = evidence.largest(name, "Fig. 4", "median rms of random assignments")
    holds = max(printed, linear, points) < limit
    evidence.partly = not holds
    return (
        "Yes" if holds else "On Figs. 4 and 5; on Fig. 3 it depends on the norm",
        f"At equal load it changes A0 by {_percent(printed)} on Fig. 5, by {_percent(linear)} on Fig. 4 and "
        f"by {_percent(points)} on Fig. 3 (rms of the relative change). The paper states neither the norm "
        f"nor the loads: others give {_percent(light)} to {_percent(over_rms)} on Fig. 3, all in the median "
        "of 1,000 assignments of the heights to sites.",
    )


def _model(evidence: Evidence) -> tuple[str, str]:
    name = "block_or_layer"
    area = "largest relative difference of A0 from the block"
    separation = "largest difference of separation [µm]"
    layer, half_space = (
        (evidence.largest(name, which, area), evidence.largest(name, which, separation))
        for which in ("layer", "half-space")
    )
    usual = evidence.value("interaction_error", "Fig. 3: median rms of random assignments")
    worst = evidence.largest("interaction_error", "rms with the tallest in the centre")
    return (
        "Order 3 on the bonded layer",
        f"Interacting(substrate=BondedLayer()) is within {_percent(layer[0])} of the true block in A0 and "
        f"within {number(layer[1], 2)} µm in the separation; the half-space is {_percent(half_space[0])} and "
        f"{number(half_space[1], 2)} µm off. Independent() is typically up to {_percent(usual, 1)} off, and "
        f"{_percent(worst)} with the tallest asperities in the centre. Automatic() where contacts may merge.",
    )


def _exact(evidence: Evidence) -> tuple[str, str]:
    name = "order3_against_resolved"
    third = evidence.largest(name, "order 3: error of A0")
    first = evidence.largest(name, "order 1: error of A0 [%]")
    wide = evidence.value("stability_map", "order 3 up to a/r = 0.32 on the half-space: largest error of A0")
    most = _percent(max(third, wide))
    return (
        f"Order 3: A0 to {most}",
        f"Against resolved contacts, order 3 misses A0 by at most {most} where contact radii are up to 0.32 "
        f"of the distances, and point loads (order 1) by up to {number(first, 2)} %. This is the error of "
        "the interaction alone.",
    )


def _contacts(evidence: Evidence) -> tuple[str, str]:
    name = "contact_laws"
    rows = ("rms change of A0 [%]",)
    adhesion = [pick(name, ", w = 9 mJ/m²:", *rows) for pick in (evidence.least, evidence.largest)]
    spheres = [pick(name, ", spheres:", *rows) for pick in (evidence.least, evidence.largest)]
    evidence.partly = True
    return (
        f"Not with adhesion: up to {number(adhesion[1], 2)} % of A0",
        f"The adhesion energy that the paper measures, 9 mJ/m², changes A0 by {number(adhesion[0], 2)} to "
        f"{number(adhesion[1], 2)} % rms at equal load, more than elastic interaction does. Spheres "
        "instead of "
        f"paraboloids change it by {number(spheres[0], 2)} to {number(spheres[1], 2)} %.",
    )


def _cost(evidence: Evidence) -> tuple[str, str]:
    name, surface = "work_precision", SCENES["paper"].title
    law, one = (
        evidence.value(name, f"{surface}: Interacting(order=3), {kind} [s]")
        for kind in ("each load of a curve", "one load")
    )
    headline = f"{number(1e6 * law, 2)} µs for each load"
    sentence = (
        f"On 64 asperities order 3 takes {number(1e6 * one, 2)} µs for one load and {number(1e6 * law, 2)} µs"
        " for each load of a curve."
    )
    ratio = f"{surface}: time of tamaas at 0.5 % over that of order 3, "
    if not evidence.has(name, ratio):
        return headline, f"{sentence} tamaas is not installed, with which the report compares it."
    moments = ratio.replace("tamaas", "tamaas, second moments")
    cold, curve, cold_moments, curve_moments = (
        number(evidence.value(name, f"{begin}{kind}"), 2)
        for begin in (ratio, moments)
        for kind in ("one load of a new surface", "each load of a curve")
    )
    return (
        headline,
        f"{sentence} The general solver tamaas, which also handles merged contacts, takes {cold} and {curve} "
        "times as long on the grid whose reported area is exact to 0.5 %, or "
        f"{cold_moments} and {curve_moments} times if its area is read from the second moments of "
        "its pressures.",
    )


def _fails(evidence: Evidence) -> tuple[str, str]:
    name = "random_scenes"
    failed, refused = (
        evidence.value(name, row)
        for row in ("scenes that fail", "inside the ranges: scenes that are refused")
    )
    outside = evidence.largest(name, "outside", "refused")
    total = evidence.value(name, "scenes")
    return (
        f"{number(failed)} of {number(total)} random scenes failed",
        "A failed scene ends without a solution and without a stated reason. Inside the documented ranges "
        f"{number(refused)} scenes were refused with a reason, outside them {_percent(outside)}, "
        "mostly designs that would reach the base plane.",
    )


def _measurements(evidence: Evidence) -> tuple[str, str]:
    name = "contact_calibration"
    own = evidence.largest(name, "mJ/m²: bias of E* over its uncertainty")
    held = evidence.least(name, "mJ/m²: 68 % intervals of E* that hold it")
    line = evidence.largest(name, "1 contact", "paper's line, mean E*") / MODULUS - 1.0
    return (
        "Yes, where the contacts obey the fitted law",
        f"In synthetic tests with the paper's errors the bias of E* is at most {_percent(own, 1)} of its "
        f"uncertainty, and its 68 % intervals hold the true value in at least {_percent(held, 3)} "
        "of the tests. "
        f"The paper's straight line gives an E* {_percent(line)} too large if one contact has the "
        "load. Large "
        "strain shifts E* by a few percent more.",
    )


def _designs(evidence: Evidence) -> tuple[str, str]:
    name = "any_law"
    deviation = evidence.largest(name, "friction proportional to load", "largest deviation")
    return (
        f"Friction proportional to load to {_percent(deviation)}",
        f"A surface with F proportional to P over a factor of "
        f"{number(evidence.largest(name, 'largest over smallest load'), 2)} in load deviates by at most "
        f"{_percent(deviation)}, with and without interaction.",
    )


QUESTIONS = (
    Question("Is the paper reproduced?", _reproduced, "paper.html"),
    Question("Is elastic interaction below 2.3 %?", _interaction, "interaction.html"),
    Question("Which model should be used?", _model, "interaction.html"),
    Question("How exact are the models?", _exact, "interaction.html"),
    Question("Is Hertz's law enough?", _contacts, "contact_laws.html"),
    Question("Which laws can be designed?", _designs, "inversion.html"),
    Question("What does it cost?", _cost, "cost.html"),
    Question("Where does it fail?", _fails, "stability.html"),
    Question("Can measured parameters be trusted?", _measurements, "measurements.html"),
)
