"""Evaluates claims, in two processes, into values that can be shown, stored and compared."""

from __future__ import annotations

import json
import math
import re
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

from metafem.drawing.inline import Drawn, drawn
from validation.chapters import chosen, module_of
from validation.check import Check, Claim, Difference, Reason, Result, Row, Rows, prose
from validation.sources import Source, known_input

# The check that a claim without an error would pass.
COMPLETE = known_input("a claim is evaluated without an error")


@dataclass(frozen=True)
class Evaluated(Rows):
    """What one claim showed: its rows, its figures, and the seconds it took."""

    name: str
    title: str
    file: str
    text: str
    rows: tuple[Row, ...]
    figures: tuple[Drawn, ...]
    seconds: float = field(compare=False)

    @property
    def anchored(self) -> list[tuple[str, Check | Result]]:
        """The checks and results with their anchors, which differ for rows of one name."""
        seen: Counter[str] = Counter()
        rows = []
        for row in self.rows:
            anchor = f"{self.name}-{re.sub(r'[^a-z0-9]+', '-', row.name.lower()).strip('-')}"
            seen[anchor] += 1
            if not isinstance(row, Difference):
                rows.append((anchor if seen[anchor] == 1 else f"{anchor}-{seen[anchor]}", row))
        return rows

    @property
    def failed(self) -> list[Check]:
        """The checks that failed."""
        return [check for check in self.checks if not check.passed]


def _is(attribute: str, name: str) -> bool:
    """Whether the module of a claim holds ``SLOW = True``, or ``TIMED = True`` because it measures times."""
    return bool(getattr(module_of(name), attribute, False))


@cache
def evaluate(name: str) -> Claim:
    """Evaluate one claim; an exception is a failed check."""
    try:
        claim = module_of(name).claim()
        return replace(claim, text=prose(module_of(name).claim, claim.values))
    except Exception as error:
        return Claim(name, [_ran_into(error)])


def evaluated(name: str) -> Evaluated:
    """Evaluate one claim and draw its figures; an exception is a failed check."""
    start = time.perf_counter()
    claim = evaluate(name)
    rows, figures = list(claim.rows), []
    for title, picture in claim.figures.items():
        draw, caption = picture.draw, picture.caption
        try:
            figures.append(drawn(draw(), f"{claim.title}: {title}", caption))
        except Exception as error:
            rows.append(_ran_into(error, f"figure {title!r} "))
    file = f"{module_of(name).__name__.replace('.', '/')}.py"
    seconds = time.perf_counter() - start
    return Evaluated(name, claim.title, file, claim.text, tuple(rows), tuple(figures), seconds)


def evaluated_in(names: Sequence[str], processes: int = 2) -> Iterator[Evaluated]:
    """Evaluate claims in some processes, and then one by one those that measure times; yield each when done.

    The numbers are those of one process: each claim is evaluated in one, on one thread.
    """
    timed = [name for name in names if _is("TIMED", name)]
    others = sorted((name for name in names if name not in timed), key=lambda name: not _is("SLOW", name))
    if processes == 1 or len(others) < 2:
        yield from map(evaluated, others)
    else:
        from joblib import Parallel, delayed, parallel_config

        with parallel_config(backend="loky", inner_max_num_threads=1), warnings.catch_warnings():
            # joblib replaces a process whose memory has grown, here by what claims keep for their figures
            warnings.filterwarnings("ignore", "A worker stopped", UserWarning)
            work = Parallel(n_jobs=processes, return_as="generator_unordered")
            yield from work(delayed(evaluated)(name) for name in others)
    yield from map(evaluated, timed)


def collected(
    names: Iterable[str], processes: int = 2, done: Callable[[Evaluated], None] = lambda each: None
) -> dict[str, Evaluated]:
    """Evaluate claims and return them by name in the order of the names; `done` is told of each."""
    wanted = list(names)
    found = {}
    for each in evaluated_in(wanted, processes):
        found[each.name] = each
        done(each)
    return {name: found[name] for name in wanted}


def selected(arguments: tuple[str, ...], *, quick: bool = False) -> tuple[list[str], list[str]]:
    """Return the claims of some names and groups, or all, and those of them that `quick` leaves out."""
    names = chosen(arguments)
    left_out = [name for name in names if quick and (_is("SLOW", name) or _is("TIMED", name))]
    return [name for name in names if name not in left_out], left_out


def as_data(results: dict[str, Evaluated]) -> dict[str, Any]:
    """Return everything but the pictures as plain data; the seconds stand apart."""
    return {
        "claims": {name: _claim_data(each) for name, each in results.items()},
        "seconds": {name: round(each.seconds, 1) for name, each in results.items()},
    }


def as_json(data: dict[str, Any]) -> str:
    """Return data as JSON text."""
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _claim_data(each: Evaluated) -> dict[str, Any]:
    rows = {kind: [*map(_row_data, getattr(each, kind))] for kind in ("checks", "results", "differences")}
    figures = [{"title": drawn.title, "caption": drawn.caption} for drawn in each.figures]
    return {"title": each.title, "file": each.file, "text": each.text, **rows, "figures": figures}


def _row_data(row: Row) -> dict[str, Any]:
    """Return a row as plain data; JSON has no numbers that are not finite."""
    data = dict(vars(row))
    for key, value in data.items():
        if isinstance(value, Source):
            data[key] = {**vars(value), "kind": value.kind.value}
        elif isinstance(value, Reason):
            data[key] = value.value
        elif isinstance(value, float) and not math.isfinite(value):
            data[key] = None
    return data


def _ran_into(error: Exception, where: str = "") -> Check:
    """Return the failed check of a claim that raised an error."""
    reason = "".join(traceback.format_exception_only(error)).strip().splitlines()[-1]
    return Check(f"{where}ran into: {reason}", float("inf"), "no error", False, COMPLETE)
