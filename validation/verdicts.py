"""The answers of the report's first screen: a sentence for each question, with numbers of the claims."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from metafem.models.truncation import COMPARED
from validation.chapters import CHAPTERS
from validation.check import Result, Row
from validation.fidelity.order3_against_resolved import CROWDED
from validation.inversion.later_targets import RANGE
from validation.numbers import number
from validation.paper.interaction_error import ASSIGNMENTS
from validation.paper.measured_slopes import ENDS
from validation.published import paper, table
from validation.results import Evaluated
from validation.scenes.compression_tests import MODULUS
from validation.scenes.costs import ORDER_3, SCENES
from validation.scenes.models import AREA_ERROR, CAP_ERROR, FEW_ERROR

MISSING = "{claim} has no row {words} {name!r}; validation/verdicts.py reads it. Its rows: {rows}"


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
    """Return the answers; one of which claims were not evaluated says which part of them was."""
    return [_verdict(question, Evidence(results)) for question in QUESTIONS]


def _verdict(question: Question, evidence: Evidence) -> Verdict:
    try:
        headline, sentence = question.answer(evidence)
    except NotEvaluated as absent:
        headline, sentence = _part(question, evidence, str(absent))
        state = "absent"
    else:
        state = "partly" if evidence.partly else "holds"
    link = evidence.link(question.link) if evidence.read else ""
    failed = [check for name in dict.fromkeys(evidence.read) for check in evidence.results[name].failed]
    if failed:
        count = f"{len(failed)} check{'s' if len(failed) > 1 else ''} failed"
        return Verdict(question.text, count, f"The first one: {failed[0].name}.", link, "failed")
    return Verdict(question.text, headline, sentence, link, state)


def _part(question: Question, evidence: Evidence, absent: str) -> tuple[str, str]:
    """Return what the claims of the question's page show of which the answer needs an absent one."""
    evidence.first = None  # the evidence is the whole page
    chapter = evidence.chapter(question.link.removesuffix(".html"))
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


def _percent(value: float, digits: int = 2) -> str:
    return f"{number(100.0 * value, digits)} %"


REPRODUCED = (
    "{numbers} distinct printed numbers, {tables} of them in Tables S1 and S2, agree with the computed ones "
    "within the digits of these numbers and of the printed targets, or within their errors. Of Table S2, "
    "{outside} of {heights} heights differ by more, by up to {most} µm. The crossover load of Fig. 5, blue, "
    "was measured at {measured} mm²; the lines through the predicted law intersect at {crossing} mm²{ruled}. "
    "The second slope of the red law is predicted {slope} % above its target; the paper states that the "
    "measured slopes lie within {within} %. The printed points of Fig. 3, with three digits, give adjustment "
    "heights that differ from the printed ones by {apart} µm. In all, the report lists {differing} "
    "differences from the paper; the heights of Table S2 count once for each colour."
)
RULED = ", and the paper's rule, applied to synthetic laws of the predicted surface, gives {blue} mm²"


def _reproduced(evidence: Evidence) -> tuple[str, str]:
    numbers = [check.source for each in evidence.results.values() for check in each.numbers]
    printed = [evidence.value("fig3_operating_points", f"h_{i},a [µm]") for i in (1, 2, 3)]
    apart = np.abs(np.subtract(printed, paper()["fig3"]["adjustment_um"]))
    outside = [_s2(evidence, colour, "heights of Table S2 that differ") for colour in ("red", "blue")]
    most = max(_s2(evidence, colour, "largest difference of 64 heights [") for colour in ("red", "blue"))
    load, error = paper()["fig5"]["blue"]["measured_crossover_mm2"]
    crossing = evidence.value("fig5_bilinear", "blue: crossover load of the predicted law [mm²]")
    slope = evidence.value("fig5_bilinear", "red: fitted slope 2, deviation from the target [%]")
    chapter = evidence.chapter("paper")
    absent = sum(each is None for each in chapter)
    evidence.partly, evidence.first = True, None  # the evidence is the whole page
    words = REPRODUCED.format(
        numbers=sum(source.numbers for source in numbers),
        tables=sum(source.numbers for source in numbers if source.text.startswith("Table")),
        outside=number(sum(outside)),
        heights=sum(map(len, (table("table_s2")[colour] for colour in ("red", "blue")))),
        most=number(most, 2),
        measured=f"{load} ± {error}",
        crossing=number(crossing, 2),
        ruled=_ruled(evidence),
        within=number(1e2 * paper()["fig5"]["measured_within"]),
        slope=number(abs(slope), 2),
        apart="{:.1f}, {:.1f} and {:.1f}".format(*apart),
        # the differences of all chapters, as the list on the first page counts them
        differing=sum(len(each.differences) for each in evidence.results.values()),
    )
    left_out = f" {absent} of {len(chapter)} claims were left out of this run." if absent else ""
    return "Mostly; not the crossover measured for the blue law of Fig. 5", words + left_out


def _s2(evidence: Evidence, colour: str, words: str) -> float:
    """Return the number of a row of Table S2."""
    return evidence.largest("table_s2", f"{colour}: {words}")


def _ruled(evidence: Evidence) -> str:
    """Return what the paper's rule finds of the predicted blue law, if that was simulated in this run."""
    name = "segmented_regression"
    if name not in evidence.results:
        return ""
    return RULED.format(blue=number(evidence.value(name, "blue: crossover by the paper's rule [mm²]"), 2))


# Readings of the paper's rms, and the words of the rows of the claim.
NORMS = (
    ("of the relative change", "rms"),
    ("over the rms of A0", "rms over the rms of A0"),
    ("over the largest A0", "rms over the largest A0"),
    ("even in separation", "rms even in separation"),
    ("at loads up to 0.35 mm²", "rms at loads up to 0.35 mm²"),
)


def _interaction(evidence: Evidence) -> tuple[str, str]:
    limit = paper()["interaction"]["rms_area_difference_below"]
    name = "interaction_error"
    norms = {
        words: evidence.value(name, f"Fig. 3: median {row} of random assignments") for words, row in NORMS
    }
    printed = evidence.largest(name, "Fig. 5", "printed sites: rms")
    linear = evidence.largest(name, "Fig. 4", "median rms of random assignments")
    holds = max(printed, linear, *norms.values()) < limit
    largest = {
        figure: max(
            evidence.value(name, f"Fig. {figure} {colour}: largest rms of random assignments")
            for colour in ("blue", "red")
        )
        for figure in (4, 5)
    }
    centred = {
        figure: " to ".join(
            number(1e2 * pick(name, f"Fig. {figure}", "rms with the tallest in the centre"), 2)
            for pick in (evidence.least, evidence.largest)
        )
        for figure in (4, 5)
    }
    evidence.partly = not holds
    listed = ", ".join(f"{_percent(value, 3)} ({words})" for words, value in norms.items())
    return (
        "Yes"
        if holds
        else "Typically below it on Figs. 4 and 5; on Fig. 3 it depends on the norm and the loads",
        f"At equal load, order 3 on a half-space changes A0 by up to {_percent(printed)} on Fig. 5, with "
        f"Table S2 taken row by row, and by up to {_percent(linear)} on Fig. 4 (rms of the relative change, "
        f"median of random assignments of the heights to sites). The largest of {ASSIGNMENTS:,} "
        f"assignments is {_percent(largest[5])} on Fig. 5 and {_percent(largest[4])} on Fig. 4; with the "
        f"tallest asperities in the centre it is {centred[5]} % on Fig. 5 and {centred[4]} % on Fig. 4. "
        "The paper states an rms, but not of what, over which loads or for which sites. On Fig. 3 it is "
        f"{listed}: medians of {ASSIGNMENTS:,} assignments.",
    )


def _model(evidence: Evidence) -> tuple[str, str]:
    name = "block_or_layer"
    area = "largest relative difference of A0 from the block"
    separation = "largest difference of separation [µm]"
    layer, half_space = (
        (evidence.largest(name, which, area), evidence.largest(name, which, separation))
        for which in ("layer", "half-space")
    )
    alone = evidence.largest(name, "largest change of A0 on the block [%]")
    worst = evidence.largest("interaction_error", "rms with the tallest in the centre")
    change = "rms change of A0 by the pedestals"
    tall = evidence.value("pedestal_effect", f"Fig. 3: {change}")
    low = max(evidence.largest("pedestal_effect", f"Fig. {figure}", change) for figure in (4, 5))
    whole = evidence.largest("block_with_pedestals", "layer with pedestals: largest relative difference")
    flat = evidence.largest("block_with_pedestals", ", layer: largest relative difference")
    wide = evidence.largest("block_with_pedestals", "pedestals at the actual contact radii [%]")
    return (
        "Order 3 on the bonded layer, with pedestal=True where caps are tall",
        f"On a block with a flat top Interacting(substrate=BondedLayer()) is within {_percent(layer[0])} of "
        f"finite elements in A0 and within {number(layer[1], 2)} µm in the separation; the half-space is up "
        f"to {_percent(half_space[0])} and {number(half_space[1], 2)} µm off. The interaction on the block, "
        f"which Independent() leaves out, changes A0 by up to {number(alone, 2)} %. The pedestals on which "
        f"the caps stand change A0 by up to {_percent(low)} rms on Figs. 4 and 5 and by {_percent(tall)} "
        "on Fig. 3, whose caps are the tallest: against the block with pedestals the layer is up to "
        f"{_percent(flat)} off at one load, and up to {_percent(whole)} with pedestal=True. Here their "
        "compliance is that of small contacts; with the actual contact radii A0 changes by up to a "
        f"further {number(wide, 2)} % rms. With the tallest asperities in the centre interaction on a "
        f"half-space changes A0 by up to {_percent(worst)} rms. Use Automatic() where contacts may merge.",
    )


def _exact(evidence: Evidence) -> tuple[str, str]:
    name, error = "order3_against_resolved", "order 3: error of A0"
    wide, crowded = "3 x 3, approach 300 µm", f"3 x 3, a/r = {CROWDED:g}, paraboloid"
    first, most = (abs(evidence.value(name, f"{each}, order 1: error of A0 [%]")) for each in (wide, crowded))
    caps = {
        shape: evidence.value(name, f"3 x 3, a/r = {CROWDED:g}, {shape}, order 3: error of A0")
        for shape in ("sphere", "power 3", "power 4")
    }
    worst = evidence.largest("stability_map", "equal contacts: error of A0 [%]")
    peer, tamaas, stated = "order3_independent", f"{error} against tamaas", _percent(AREA_ERROR)
    confirmed = (
        f"The independent code tamaas agrees within {_percent(evidence.largest(peer, tamaas))} on "
        f"{number(evidence.value(peer, 'scenes compared with tamaas'))} scenes, with an uncertainty of up to "
        f"{number(evidence.largest(peer, 'uncertainty of A0 [%]'), 2)} %."
        if evidence.has(peer, tamaas)
        else "The independent code tamaas, with which the report compares it, is not installed."
    )
    return (
        f"Order 3: A0 of paraboloids to {stated}",
        "The documentation states that order 3 misses A0 of paraboloids on a half-space by at most "
        f"{stated} where contact radii are up to {number(COMPARED)} of the distances, and by at most "
        f"{_percent(FEW_ERROR)} with up to nine contacts. Against resolved contacts the worst of the "
        f"sampled scenes of paraboloids, 64 equal contacts, has {number(worst, 2)} %; nine crowded spheres "
        f"have {_percent(caps['sphere'])}, caps of power 3 {_percent(caps['power 3'])} and of power 4 "
        f"{_percent(caps['power 4'])}, at most the stated {_percent(CAP_ERROR)}. Point loads (order 1) miss "
        f"A0 of nine paraboloids by {number(first, 2)} % where contact radii are "
        f"{number(evidence.value(name, f'{wide}: largest a/r'), 2)} of the distances and by "
        f"{number(most, 2)} % at {number(CROWDED, 2)}. {confirmed} This is the error of the interaction "
        "alone.",
    )


def _contacts(evidence: Evidence) -> tuple[str, str]:
    name, adhesion = "contact_laws", ", w = 9 mJ/m², "
    hertz, printed, refitted = (
        (evidence.largest(name, "Fig. 4", law, "[s.d.]"), evidence.largest(name, "Fig. 5", law, "target"))
        for law in (", Hertz, σ as printed:", f"{adhesion}σ as printed:", f"{adhesion}σ refitted:")
    )
    other = [
        abs(evidence.value(name, f"Fig. 4 {colour}{adhesion}σ refitted at {over:g} times the load of full "
                                 "contact: slope minus the measured one [s.d.]"))
        for colour in ("blue", "red") for over in ENDS
    ]  # fmt: skip
    single = evidence.largest(name, adhesion.rstrip(", ") + ": largest change of A0 [%]")
    area, friction = (
        [pick(name, adhesion.rstrip(", ") + words) for pick in (evidence.least, evidence.largest)]
        for words in (": rms change of A0 [%]", ", σ refitted: rms change of F [%]")
    )
    holds, measured = hertz[0] <= 1.0, 1e2 * paper()["fig5"]["measured_within"]
    evidence.partly = not holds or hertz[1] > measured
    return (
        "For the slopes of Fig. 4, yes" if holds else "Not for the slopes of Fig. 4",
        f"Hertz's law meets the slopes measured in Fig. 4 to {number(hertz[0], 2)} standard deviations. "
        f"JKR's theory with 9 mJ/m² misses them by up to {number(printed[0], 2)} with σ as printed, by up "
        f"to {number(refitted[0], 3)} with σ refitted to the same forces from the load of full contact to "
        f"twice that load, and by up to {number(max(other), 2)} with another range of loads. On Fig. 5 it "
        f"misses the targets by up to {number(printed[1], 2)} % with σ as printed and "
        f"{number(refitted[1], 2)} % with σ refitted, Hertz's law by {number(hertz[1], 2)} % with σ as "
        f"printed (heights of Table S2; measured, as the paper states: at most {number(measured)} %). "
        f"Adhesion changes A0 by {number(area[0], 2)} to {number(area[1], 2)} % rms on Figs. 3 to 5, and "
        f"by up to {number(single, 2)} % at one load; it changes the friction force by "
        f"{number(friction[0], 2)} to {number(friction[1], 2)} % rms on Figs. 4 and 5 where σ is fitted "
        "with the same law.",
    )


def _cost(evidence: Evidence) -> tuple[str, str]:
    name, surface = "work_precision", SCENES["paper"].title
    small = [each.title for each in SCENES.values() if each.title.endswith(" 64 asperities")]
    laws = [1e6 * evidence.value(name, f"{title}: {ORDER_3}, each load of a curve [s]") for title in small]
    one = evidence.value(name, f"{surface}: {ORDER_3}, one load [s]")
    spread = " to ".join(dict.fromkeys(number(each, 2) for each in (min(laws), max(laws))))
    headline = f"About {spread} µs for each load of a curve, on the machine of the run"
    sentence = (
        f"On 64 asperities order 3 takes {number(1e6 * one, 2)} µs for one load and {spread} µs for each "
        f"load of a curve, on {len(small)} surfaces. Times are rounded to 1, 2 or 5, and depend on the "
        "machine."
    )
    ratio = ("time of tamaas", f"over that of {ORDER_3}")
    if not evidence.has(name, ratio[0]):
        return headline, f"{sentence} tamaas is not installed, with which the report compares it."
    figure = surface.partition(",")[0]
    return (
        headline,
        f"{sentence} The general solver tamaas, which also handles merged contacts, takes at least "
        f"{number(evidence.least(name, *ratio))} times as long on the surface of "
        f"{figure}, the smallest of the ratios for a new surface and for "
        "each load of a curve: for errors of A0 of at most 0.5 % and 0.1 %, by each reading of its area "
        "that reaches them.",
    )


def _fails(evidence: Evidence) -> tuple[str, str]:
    name = "random_scenes"
    failed, solver, search, refused, total, equations = (
        evidence.value(name, row)
        for row in (
            "scenes that fail", "scenes whose solver does not converge",
            "designs whose search misses the target", "inside the ranges: scenes that are refused", "scenes",
            "scenes whose equations are recomputed",
        )
    )  # fmt: skip
    inside = evidence.value(name, "inside the ranges: scenes that are not solved")
    outside = evidence.value(name, "outside the ranges: part of the scenes that is refused or not solved")
    unsolved = failed + solver + search - inside
    none = number(inside) if inside else "None"
    return (
        f"{none} of the scenes inside the documented ranges, {number(unsolved)} of those outside",
        f"Of {number(total)} random scenes, half of them outside the ranges, the solver found no solution of "
        f"{number(solver)} and the search of a design missed the target of {number(search)}; "
        f"{_count(inside)} of these are inside the ranges. {_count(failed).capitalize()} ended without a "
        f"stated reason, and {_count(refused)} inside the ranges were refused. Outside them "
        f"{_percent(outside)} had no solution, mostly designs that would reach the base plane. The "
        f"equations of {number(equations)} scenes were recomputed.",
    )


def _count(value: float) -> str:
    """Return a whole number, in a word if it is zero."""
    return number(value) if value else "none"


def _measurements(evidence: Evidence) -> tuple[str, str]:
    name = "contact_calibration"
    own = evidence.largest(name, "mJ/m²: bias of E* over its uncertainty")
    held = evidence.least(name, "mJ/m²: 68 % intervals of E* that hold it")
    one, five = (
        evidence.value(name, f"{count}, w = 9 mJ/m²: paper's line, mean E* [MPa]") / MODULUS - 1.0
        for count in ("1 contact", "5 contacts")
    )
    bias = "large strain: largest bias of E*, a/R up to 0.5, over the published uncertainty"
    strain = (
        f" Contacts that obey the law of a soft cap at large strain bias E* by up to "
        f"{number(evidence.value('calibration_bias', bias), 2)} times the uncertainty that the paper states."
        if "calibration_bias" in evidence.results
        else ""
    )
    return (
        "E*, yes, where contacts obey the fitted law and errors are as stated",
        f"In synthetic tests with the paper's errors the bias of E* is at most {_percent(own, 1)} of its "
        f"uncertainty, and its 68 % intervals hold the true value in at least {_percent(held, 3)} of the "
        f"tests. The paper's straight line gives an E* {_percent(five)} too large in the mean with five "
        f"contacts under the load, as in the paper, and {_percent(one)} with one.{strain}",
    )


def _designs(evidence: Evidence) -> tuple[str, str]:
    name, radii, later = "any_law", "several_radii", "later_targets"
    deviation = evidence.largest(name, "friction proportional to load", "largest deviation")
    stepped = evidence.largest(name, "on steps of 6 µm: misfit")
    wide, widest = (
        evidence.value(later, "largest exponent within 1 %"),
        evidence.value(radii, "largest exponent within 1 % with two tools"),
    )
    least = evidence.value(later, "caps of power 4, power 0.5 of the load: exponent by bisection")
    misfit = evidence.value(later, "largest misfit of these designs")
    line = evidence.value(name, "μ = 0.9 with the best tool: misfit")
    return (
        f"Powers {number(least, 2)} to {number(widest, 2)} of the load, two slopes, and points, within 1 %",
        f"Paraboloids of one radius have powers 2/3 to {number(wide, 3)} of the load over a factor of "
        f"{number(RANGE[1] / RANGE[0])} in load; two tools reach {number(widest, 3)}, caps of power 4 reach "
        f"{number(least, 2)}: the ends are met within 1 %, single powers and pairs of slopes between them to "
        f"{_percent(misfit)}; three operating "
        f"points, two powers and two slopes on height steps of 6 µm to {_percent(stepped)}. Friction "
        "proportional to load over a factor of "
        f"{number(evidence.largest(name, 'largest over smallest load'), 2)} in load is met to "
        f"{_percent(deviation)} for independent asperities, a half-space and a layer, each under its own "
        "model. A straight line without a stated range has an intercept and is approximate: with μ = 0.9, "
        f"which needs another tool, the slope deviates by {_percent(line)}. A law that no surface within the "
        "limits reaches is "
        "refused with the reason, or ends as missed with its misfit.",
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
