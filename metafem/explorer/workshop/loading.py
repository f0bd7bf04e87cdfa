"""Files that the user loads into a page: a specification with its tables, or only tables."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.control import Control
from metafem.explorer.session import State
from metafem.explorer.text.document import section_of
from metafem.explorer.text.names import order_of

# Name of the specification in a result folder.
KEPT = "spec.toml"


@dataclass(frozen=True)
class Given:
    """A file that the user selected or dropped: its name, and its text or why it could not be read."""

    name: str
    text: str = ""
    why: str = ""


async def load(page: Control, files: list[dict[str, Any]]) -> None:
    """Show the specification in loaded files, or a message why they cannot be used."""
    given = [Given(**each) for each in files]
    await page.told(page.step(lambda state: loaded(state, given)))


def loaded(state: State, files: list[Given]) -> State:
    """Return the state with the specification in the files, or with new tables for the old specification.

    Raises
    ------
    InvalidInput
        If no file is a specification or table that can be used; the message states the reason.
    """
    unread = [f"{each.name} {each.why}." for each in files if each.why]
    texts = {each.name: each.text for each in files if not each.why}
    specifications = {name: text for name, text in texts.items() if name.lower().endswith(".toml")}
    tables = {name: text for name, text in texts.items() if name.lower().endswith((".csv", ".txt", ".tsv"))}
    if len(specifications) > 1:
        specifications = {name: text for name, text in specifications.items() if name == KEPT}
        if not specifications:
            raise InvalidInput("These are several specifications. Load one of them, with its tables.")
    if specifications:
        ((name, text),) = specifications.items()
        _refuse_foreign(name, text)
        for each in files:
            if each.why and _named(text, {each.name: ""}):
                raise InvalidInput(f"{name} names the table {each.name}, which {each.why}.")
        return replace(state, text=text, tables=_named(text, tables))
    named = _named(state.text, tables)
    if named:
        return replace(state, tables={**state.tables, **named})
    if tables:
        table, known = next(iter(tables)), ", ".join(table_names(state.text)) or "no table"
        raise InvalidInput(
            f'{table} is a table. The specification names {known}. To use it, write file = "{table}" into '
            "[target] or [contact] first. To compare with a measured law, drop it onto the plot of the law."
        )
    others = [f"{name} is no specification." for name in texts]
    remedy = f"Load a .toml file, such as the {KEPT} of a result folder, with the tables that it names."
    raise InvalidInput(" ".join([*unread, *others, remedy]))


def table_names(text: str) -> tuple[str, ...]:
    """Return the file names of the tables that a specification refers to.

    Examples
    --------
    >>> table_names('[target]\\nfile = "wanted.csv"')
    ('wanted.csv',)
    """
    found = [section_of(text, name).get("file") for name in ("target", "cap", "contact")]
    return tuple(name for name in found if isinstance(name, str))


def _named(text: str, tables: Mapping[str, str]) -> dict[str, str]:
    """Return the tables that a specification refers to, by the names in the specification."""
    last = {name: re.split(r"[/\\]", name)[-1] for name in table_names(text)}
    return {name: tables[part] for name, part in last.items() if part in tables}


def _refuse_foreign(name: str, text: str) -> None:
    """Raise InvalidInput for a text without any section of a specification.

    A specification with errors is accepted, because the user can correct it on the page.
    """
    sections = "|".join(order_of(""))
    if not re.search(rf"^[ \t]*(\[[ \t]*({sections})\b|({sections})[ \t]*[.=])", text, re.MULTILINE):
        raise InvalidInput(
            f"{name} is no specification: it has none of the sections, such as [target]. "
            "The menu of the page has examples to start over from."
        )
