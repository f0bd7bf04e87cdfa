"""Sources in the tables of the report, with places where long names may break."""

from __future__ import annotations

import re
from html import escape

from validation.numbers import powers

# Where a name may break: behind dots, underscores and slashes; and code, behind brackets and signs as well.
IN_NAMES = re.compile(r"(?<=[A-Za-z])[._](?=\w)|/(?=[a-z]{3})")
IN_CODE = re.compile(r"[(=,._|](?=[^\s)])")


def cited(text: str) -> str:
    """Return a source as HTML, in which long names may break."""
    return breaking(escape(powers(text)))


def breaking(text: str, places: re.Pattern[str] = IN_NAMES) -> str:
    """Return HTML without tags, in which long names may break at some places."""
    return places.sub(r"\g<0><wbr>", text)
