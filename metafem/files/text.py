"""A text file is there whole or not at all."""

from __future__ import annotations

import os
import secrets
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
    target = Path(path).absolute()
    fresh = target.with_name(f".{target.name}.{secrets.token_hex(4)}.new")
    try:
        if target.exists() and not force:
            raise InvalidInput(
                f"{target} exists; choose another name, or replace it with --force (force=True)"
            )
        fresh.write_bytes(text.encode("utf-8"))
        os.replace(fresh, target)
    except OSError as error:
        raise InvalidInput(f"{target} cannot be written: {error.strerror}") from None
    finally:
        with suppress(OSError):  # it is not there any more, or never was
            fresh.unlink()
