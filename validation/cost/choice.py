"""What is chosen for a scene and a tolerance, its time, and whether a cheaper model would suffice."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import metafem as mf
from validation.check import Claim, Row, Table, below, reported
from validation.cost.measured import Point, models
from validation.cost.times import in_words, machine, percent, rounded
from validation.scenes.costs import (
    AUTOMATIC,
    MODELS,
    ORDER_3,
    RESOLVED,
    SCENES,
    TOLERANCES,
    Reference,
    reference,
)
from validation.scenes.ladder import Choice, choices
from validation.sources import known_input, second_method

# Lines of the models of the ladder, from the cheapest on, and their names.
LADDER = {
    "Independent()": "independent",
    "Interacting(order=1)": "order 1",
    ORDER_3: "order 3",
    RESOLVED: "resolved",
}

# Random scenes on which the choices are counted.
RANDOM = 500

HEADER = (
    "tolerance", "chosen model", "time", "estimated error", "error",
    "next cheaper model", "its time", "its error",
)  # fmt: skip

# Marks a row in which a cheaper model met the tolerance.
MARK = " *"

COUNTED = "rows of the table"
OVERHEAD = "one load of a new surface, medians, rounded to 1, 2 or 5"
STATED = known_input("stated bound of the choice: one in ten, on random scenes")


@dataclass(frozen=True)
class Chosen:
    """What `Automatic` chose for a scene and a tolerance: a line of `LADDER`, and the lines before it."""

    scene: str
    tolerance: float
    point: Point
    line: str

    @property
    def lower(self) -> list[str]:
        """The lines of the cheaper models, from the cheapest on."""
        return [*LADDER][: [*LADDER].index(self.line)]

    @property
    def cheaper(self) -> dict[str, Point]:
        """The cheaper models that have a solution, by their lines."""
        found = {each.line: each for each in models(self.scene)}
        return {line: found[line] for line in self.lower if line in found}

    @property
    def needed(self) -> bool:
        """Whether no cheaper model met the tolerance."""
        return all(each.area_error > self.tolerance for each in self.cheaper.values())


def measure() -> Claim:
    """Automatic(tolerance) solves independent asperities first, then order 1, then order 3, and resolves the
    contacts last. It stops at the first model whose error, estimated from its own solution, is within the
    tolerance. So the time of an answer follows from the scene and the tolerance.

    In {needed} of the {total} choices of the table no cheaper model is within the tolerance. In the others,
    marked with *, a cheaper model is within it, which its estimated error does not show. Of {random} choices
    on random scenes, where order 3 is the reference, {share} are more expensive than necessary.

    The command python -m validation cost writes this chapter with all its numbers. {machine}
    """
    found = [each for scene in SCENES for each in choice(scene)]
    of_random = Choice(*np.array(choices(RANDOM)).T)
    above = of_random.chosen > of_random.cheapest
    exact = second_method(mf.Interacting, "order 3, where its estimated error is negligible")
    what = f"{len(above):,} choices on random scenes"
    rows: list[Row] = [
        below(f"{what}: largest error of A0 over the tolerance",
              (of_random.error / of_random.tolerance).max(), 1.0, exact),
        below(f"{what}: share of models more expensive than necessary", above.mean(), 0.1, STATED),
        reported("choices of the table", len(found), COUNTED),
        reported("choices of the table for which no cheaper model is within the tolerance",
                 sum(each.needed for each in found), COUNTED),
        *_overheads(found),
    ]  # fmt: skip
    values = {
        "needed": sum(each.needed for each in found),
        "total": len(found),
        "random": f"{len(above):,}",
        "share": percent(float(above.mean())),
        "machine": machine(),
    }
    return Claim("What Automatic chooses", rows, {}, values, table=_table(found))


def choice(scene: str) -> list[Chosen]:
    """Return what `Automatic` chose with each tolerance."""
    lines = {model: line for line, settings in MODELS.items() for model in settings.values()}
    return [
        Chosen(scene, float(each.setting), each, lines.get(each.solved, RESOLVED))
        for each in models(scene)
        if each.line == AUTOMATIC
    ]


def _overheads(found: list[Chosen]) -> Iterator[Row]:
    """Report the largest time of `Automatic` over that of the asperity model that it chose."""
    for scene, known in SCENES.items():
        alone = {each.line: each.cold for each in models(scene) if each.line in MODELS}
        chosen = [each for each in found if each.scene == scene and each.line in alone]
        if chosen:
            name = f"{known.title}: largest time of Automatic over that of the model that it chose"
            ratio = max(each.point.cold / alone[each.line] for each in chosen)
            yield reported(name, rounded(ratio), OVERHEAD)


def _table(found: list[Chosen]) -> Table:
    """Return the choices, scene by scene, with those that were not computed."""
    caption = (
        "One load of a new surface by Automatic(tolerance). Times are medians, rounded to 1, 2 or 5. Errors "
        "are those of A0 against resolved contacts, and for 400 and 10,000 asperities against order 3, whose "
        "own estimate stands for its error. *: a cheaper model is within the tolerance too. Not computed: "
        "resolved contacts with more than a million cells in contact. The size of the cells, in µm, is "
        "chosen before the contacts are resolved; their estimated error is that of the solution. Above 2,000 "
        "asperities contacts are not resolved: where order 3 is not within the tolerance, a warning says so."
    )
    absent = (LADDER[RESOLVED], "not computed", *("–",) * 5)
    parts: dict[str, list[tuple[str, ...]]] = {}
    for scene, known in SCENES.items():
        cells = {each.tolerance: _cells(each) for each in found if each.scene == scene}
        parts[known.title] = [(percent(each), *cells.get(each, absent)) for each in TOLERANCES]
    return Table(caption, HEADER, parts)


def _cells(each: Chosen) -> tuple[str, ...]:
    """Return the row of a choice, without its tolerance."""
    exact, point = reference(each.scene), each.point
    name = LADDER[each.line]
    if isinstance(point.solved, mf.BoundaryElements):
        name += f", {1e3 * point.solved.cell:.2g} µm"
    cheaper = ("none", "–", "–")
    if each.lower:
        known = each.cheaper.get(each.lower[-1])
        found = (in_words(known.cold), _error(known, exact)) if known else ("–", "no solution")
        cheaper = (LADDER[each.lower[-1]], *found)
    return (
        name + ("" if each.needed else MARK),
        in_words(point.cold),
        percent(point.estimate),
        _error(point, exact),
        *cheaper,
    )


def _error(point: Point, exact: Reference) -> str:
    """Return the error of A0, or the uncertainty of the reference if it is smaller."""
    if point.area_error <= exact.area_uncertainty:
        return f"< {percent(exact.area_uncertainty)}"
    return percent(point.area_error)
