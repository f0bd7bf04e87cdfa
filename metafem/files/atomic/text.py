"""A file is there whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from metafem.errors import InvalidInput


def write_text(path: str | Path, text: str, *, force: bool = False) -> None:
    """Write a text in UTF-8; an existing file is refused unless `force` is true.

    Raises
    ------
    InvalidInput
        If the file exists or cannot be written; nothing is left behind.
    """
    write_file(path, lambda fresh: fresh.write_bytes(text.encode("utf-8")), force=force)


def write_file(path: str | Path, write: Callable[[Path], object], *, force: bool = False) -> None:
    """Let `write` fill a new file, which then takes its place; as `write_text`."""
    target = Path(path).absolute()
    fresh = target.with_name(f".{target.name}.{secrets.token_hex(4)}.new")
    try:
        refuse_existing(target, force)
        write(fresh)
        os.replace(fresh, target)
    except OSError as error:
        raise InvalidInput(f"{target} cannot be written: {error.strerror or error}") from None
    finally:
        with suppress(OSError):  # it is not there any more, or never was
            fresh.unlink()


def refuse_existing(path: str | Path, force: bool) -> None:
    """Raise InvalidInput if the file exists: worth knowing before a long run."""
    target = Path(path).absolute()
    if target.exists() and not force:
        raise InvalidInput(f"{target} exists; choose another name, or replace it with force=True")
