"""Evaluates claims, in two processes."""

from __future__ import annotations

import traceback
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from time import perf_counter

from metafem.drawing.inline import drawn
from validation.chapters import module_of
from validation.check import Check, Claim, prose
from validation.sources import known_input

# The check that a claim without an error would pass.
COMPLETE = known_input("a claim is evaluated without an error")


def marked(attribute: str, name: str) -> bool:
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


def evaluated(name: str) -> Claim:
    """Evaluate one claim and draw its figures; an exception is a failed check."""
    start = perf_counter()
    claim = evaluate(name)
    rows, figures = list(claim.rows), []
    for title, picture in claim.figures.items():
        try:
            figures.append(drawn(picture.draw(), f"{claim.title}: {title}", picture.caption))
        except Exception as error:
            rows.append(_ran_into(error, f"figure {title!r} "))
    file = f"{module_of(name).__name__.replace('.', '/')}.py"
    found = {"rows": rows, "figures": {}, "drawn": figures, "name": name, "file": file}
    return replace(claim, **found, seconds=perf_counter() - start)


def evaluated_in_turn(names: Sequence[str]) -> Iterator[Claim]:
    """Evaluate claims in two processes, and then one by one those that measure times; yield each when done.

    The numbers are those of one process: each claim is evaluated in one, on one thread.
    """
    timed = [name for name in names if marked("TIMED", name)]
    others = sorted(set(names).difference(timed), key=lambda name: not marked("SLOW", name))
    if len(others) < 2:
        yield from map(evaluated, others)
    else:
        from joblib import Parallel, delayed, parallel_config

        with parallel_config(backend="loky", inner_max_num_threads=1), warnings.catch_warnings():
            # joblib replaces a process whose memory has grown, here by what claims keep for their figures
            warnings.filterwarnings("ignore", "A worker stopped", UserWarning)
            work = Parallel(n_jobs=2, return_as="generator_unordered")
            yield from work(delayed(evaluated)(name) for name in others)
    yield from map(evaluated, timed)


def _ran_into(error: Exception, where: str = "") -> Check:
    """Return the failed check of a claim that raised an error."""
    reason = "".join(traceback.format_exception_only(error)).strip().splitlines()[-1]
    return Check(f"{where}ran into: {reason}", float("inf"), "no error", False, COMPLETE)
