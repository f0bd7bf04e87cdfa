"""The pages of the programming interface: one for each module, and a list of all names."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any

from validation.pages import site_page
from validation.site import interface
from validation.site.docstrings import Address, html, linked, summary
from validation.site.extras import refuse_missing_docs
from validation.site.interface import Entry, Member, Page, addresses, pages
from validation.site.signatures import result, signature

# Title of the names of a module that has no groups.
ALL = "Classes and functions"

# Longest signature on one line.
WIDEST = 96


def write_api(folder: Path) -> list[str]:
    """Write the pages of all public names into ``folder/api``, and return their addresses."""
    refuse_missing_docs()
    target = folder / "api"
    target.mkdir(parents=True, exist_ok=True)
    listed = []
    for page in pages().values():
        address = address_on(page)
        shown = {
            "text": html(page.docstring, address),
            "elsewhere": ", ".join(linked(name, address) for name in page.elsewhere),
            "groups": [
                (title or ALL, [_shown(e, address) for e in entries])
                for title, entries in page.groups.items()
            ],
        }
        text = site_page("module.html", here=f"api/{page.name}.html", page=page, **shown)
        (target / f"{page.name}.html").write_text(text, "utf-8")
        listed.append(_summaries(page))
    text = site_page("reference.html", here="api/index.html", modules=listed)
    (target / "index.html").write_text(text, "utf-8")
    return ["api/index.html", *(f"api/{name}.html" for name in pages())]


def address_on(page: Page | None = None) -> Address:
    """Return a function that finds the address of a name; names of the page itself come first.

    A word that is also the name of a parameter or an attribute has none, unless its module stands before it.
    """

    def address(name: str) -> str | None:
        if name in interface.value_names():
            return None
        own = None if page is None else addresses().get(f"{page.name}.{name}")
        return own or addresses().get(name)

    return address


def _summaries(page: Page) -> tuple[Page, str, list[tuple[str, list[tuple[str, str, str]]]]]:
    """Return a module with its first paragraph and those of its names."""
    address = address_on(page)

    def listed(entry: Entry) -> tuple[str, str, str]:
        return entry.name, f"{page.name}.html#{entry.name}", summary(entry.docstring, address)

    groups = [(title or ALL, [*map(listed, entries)]) for title, entries in page.groups.items()]
    return page, summary(page.docstring, address), groups


def _shown(entry: Entry, address: Address) -> dict[str, Any]:
    """Return what the page shows of a name."""
    of_class = inspect.isclass(entry.value)
    inner = interface.members(entry.value) if of_class else []
    above = interface.inherited(entry.value) if of_class else {}
    rest = entry.docstring.partition("\n\n")[2]
    return {
        "name": entry.name,
        "kind": entry.kind,
        "call": entry.name + call(entry.value, address) if entry.is_called else "",
        "summary": summary(entry.docstring, address),
        "text": html(rest, address) if rest else "",
        "constants": entry.constants,
        "short": [_member(each, address) for each in inner if not each.is_long],
        "long": [_member(each, address) for each in inner if each.is_long],
        "inherited": [
            (linked(base, address), ", ".join(_of(base, name, address) for name in names))
            for base, names in above.items()
        ],
    }


def _member(member: Member, address: Address) -> dict[str, str]:
    """Return what the page shows of a method or a property."""
    text = (html if member.is_long else summary)(member.docstring, address)
    widest = WIDEST if member.is_long else sys.maxsize
    shown = "" if member.kind == "property" else call(member.function, address, widest)
    return {"name": member.name, "kind": member.kind, "call": shown, "text": text}


def _of(base: str, name: str, address: Address) -> str:
    """Return the name of a member as a link to where another class explains it."""
    target = address(f"{base}.{name}")
    return name if target is None else f'<a href="{target}">{name}</a>'


def call(value: Callable[..., Any], address: Address, widest: int = WIDEST) -> str:
    """Return the parameters in parentheses and the type of the result; beyond a width, one a line."""
    parts, returned = signature(value), result(value)
    arrow = f" → {returned}" if returned and returned != "None" else ""
    line = f"({', '.join(parts)}){arrow}"
    if len(line) > widest:
        line = "(\n" + "".join(f"    {part},\n" for part in parts) + f"){arrow}"
    # types alone are links: a word behind a colon, a bar, a bracket or the arrow
    return re.sub(
        r"(?<=[:|→\[,] )([A-Z]\w+)|(?<=\[)([A-Z]\w+)", lambda found: linked(found[0], address), escape(line)
    )
