"""Links: conversion of the state of a page to a short text for the address, and back."""

from __future__ import annotations

import base64
import json
import zlib
from contextlib import suppress
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.session import Session, State

# First characters of a link: the version of its format.
VERSION = "1."

# Longest link that browsers accept in an address [characters], and largest state [bytes]. A state with a
# thousand measured points has 40 kB.
LONGEST, LARGEST = 2**20, 2**24


def to_link(state: State) -> str:
    """Return a state as a link of letters, digits, hyphens, underscores and a point; "" if it is too large.

    Examples
    --------
    >>> link = to_link(State("[layout]\\nseed = 3", newtons=False))
    >>> len(link) < 100, from_link(link).newtons
    (True, False)
    """
    usual, record = (json.loads(each.to_json()) for each in (State(""), state))
    record = {name: value for name, value in record.items() if name == "text" or value != usual[name]}
    plain = json.dumps(record, ensure_ascii=False, separators=(",", ":")).encode("utf-8", "surrogatepass")
    link = VERSION + base64.urlsafe_b64encode(zlib.compress(plain, 9)).decode("ascii").rstrip("=")
    return link if len(plain) <= LARGEST and len(link) <= LONGEST else ""


def from_link(link: str) -> State:
    """Return the state that a link contains; the link may begin with a number sign.

    Raises
    ------
    InvalidInput
        If the link is cut off, damaged, of another version or too long.

    Examples
    --------
    >>> from_link("#1.eJyr")
    Traceback (most recent call last):
        ...
    metafem.errors.InvalidInput: the link is cut off or damaged; copy the whole address again
    """
    link = link.strip().removeprefix("#")
    if len(link) > LONGEST:
        raise InvalidInput(f"the link has {len(link):,} characters; at most {LONGEST:,} are read")
    if not link.startswith(VERSION):
        raise InvalidInput("the link is not one of this version of the explorer")
    body, reader, plain = link.removeprefix(VERSION), zlib.decompressobj(), b""
    with suppress(InvalidInput, TypeError, ValueError, zlib.error):
        packed = base64.b64decode(body + "=" * (-len(body) % 4), b"-_", validate=True)
        plain = reader.decompress(packed, LARGEST + 1)
        if len(plain) <= LARGEST and reader.eof and not reader.unused_data:
            return State.from_json(plain.decode("utf-8", "surrogatepass"))
    if len(plain) > LARGEST:
        raise InvalidInput(f"the link holds more than {LARGEST / 2**20:g} MiB")
    raise InvalidInput("the link is cut off or damaged; copy the whole address again")


def restored(kept: Any, first: Session) -> tuple[Session, str]:
    """Return the history that the browser stored, or else `first`, and the error messages, "" if none.

    If the address contains a different state, this state becomes the last step of the history.
    """
    session, problems = first, list[str]()
    try:
        session = Session.restored(kept) or first
    except InvalidInput as error:
        problems.append(str(error))
    try:
        link = kept.get("link") if isinstance(kept, dict) else ""
        if link and link != to_link(session.state):
            session = session.after(from_link(link))
    except InvalidInput as error:
        problems.append(str(error))
    return session, "; ".join(problems)
