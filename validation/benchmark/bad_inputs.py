"""Commands that read damaged files and end with a traceback, a wrong exit code or no message."""

from __future__ import annotations

import sys

from validation.scenes.damaged_files import LIMIT, measure
from validation.timing import Row

# Number of damaged files.
COUNT = 3_000


def rows(count: int = COUNT) -> list[Row]:
    """Count the damaged files whose command does not end as it must."""
    tally = measure(count)
    for found in (tally.tracebacks, tally.hangs, tally.codes, tally.lines):
        for text in found:
            print(text, file=sys.stderr)
    of = f"{count} damaged records, specifications and tables"
    return [
        Row(f"{of}: tracebacks, or warnings of libraries", 0, len(tally.tracebacks), ""),
        Row(f"{of}: processor time above {LIMIT} s", 0, len(tally.hangs), ""),
        Row(f"{of}: exit codes other than 0, 1 and 2", 0, len(tally.codes), ""),
        Row(f"{of}: messages with other than one line per problem", 0, len(tally.lines), ""),
    ]
