"""Commands that read damaged files and end with a traceback, a wrong exit code or no message."""

from __future__ import annotations

import sys
from itertools import chain

from validation.scenes.damaged_files import measure
from validation.timing import Row

# Number of damaged files.
COUNT = 3_000


def rows(count: int = COUNT) -> list[Row]:
    """Count the damaged files whose command does not end as it must."""
    faults = measure(count).faults
    print(*chain(*faults.values()), sep="\n", file=sys.stderr)
    of = f"{count} damaged records, specifications and tables"
    return [Row(f"{of}: {what}", 0, len(found)) for what, found in faults.items()]
