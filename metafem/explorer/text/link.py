"""Links: conversion of the state of a page to a short text for the address, and back."""

from __future__ import annotations

import base64
import json
import zlib
from contextlib import suppress

from metafem.errors import InvalidInput
from metafem.explorer.session import State

# First characters of a link: the version of its format.
VERSION = "1."

# Longest link [characters], because NiceGUI drops messages of a megabyte, and largest state [bytes]. A state
# with a thousand measured points has 40 kB.
LONGEST, LARGEST = 900_000, 2**24


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
