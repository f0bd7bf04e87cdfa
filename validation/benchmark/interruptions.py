"""Files lost or left by runs that are stopped at random moments, and by pairs of runs with one folder."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from validation.scenes.stopped_runs import kills, pairs, scene
from validation.timing import Row

# Stopped runs, and pairs of runs.
KILLS, PAIRS = 200, 50


def long_rows(count: int = KILLS, twice: int = PAIRS) -> Iterator[Row]:
    """Count the failures of stopped runs and of pairs of runs."""
    with scene() as known:
        for title, tally in (("stopped", kills(known, count)), ("pair", pairs(known, twice))):
            yield from (
                Row(f"{title}, failures of: {what}", 0.0, float(tally.failures[what]), f"of {trials}")
                for what, trials in tally.trials.items()
            )
            print(dict(tally.counts), file=sys.stderr)
            for what, detail in tally.first.items():
                print(f"{title}: {what}: {detail}", file=sys.stderr)
