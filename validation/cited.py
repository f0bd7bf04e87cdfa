"""Sources in the tables of the report: links to the reference, and places where long names may break."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path

from validation.numbers import powers

ROOT = Path(__file__).parents[1]

# Names of functions and classes of the package and of the validation, with their modules.
NAME = re.compile(r"\b((?:metafem|validation)(?:\.\w+)+)")

# Where a name may break: behind dots, underscores and slashes; and code, behind brackets and signs as well.
IN_NAMES = re.compile(r"(?<=[A-Za-z])[._](?=\w)|/(?=[a-z]{3})")
IN_CODE = re.compile(r"[(=,._|](?=[^\s)])")


def cited(text: str, *, whole: bool) -> str:
    """Return a source as HTML; a site with the reference links public names, and says the file of others."""
    pieces = NAME.split(powers(text))
    pieces[0::2] = [breaking(escape(each)) for each in pieces[0::2]]
    pieces[1::2] = [_shown(name) if whole else breaking(name) for name in pieces[1::2]]
    return "".join(pieces)


def breaking(text: str, places: re.Pattern[str] = IN_NAMES) -> str:
    """Return HTML without tags, in which long names may break at some places."""
    return places.sub(r"\g<0><wbr>", text)


def _shown(name: str) -> str:
    """Return a name as a link to the reference, or with the file that defines it."""
    from validation.site.interface import addresses

    parts = name.split(".")
    known = addresses()
    for public in (".".join([*parts[:count], parts[-1]]) for count in range(len(parts) - 1, 0, -1)):
        if public in known:
            return f'<a href="api/{known[public]}">{breaking(public)}</a>'
    for count in range(len(parts) - 1, 0, -1):
        file = Path(*parts[:count]).with_suffix(".py")
        if (ROOT / file).exists():
            return breaking(f"{'.'.join(parts[count:])} in {file.as_posix()}")
    return breaking(name)
