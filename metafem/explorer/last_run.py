"""Token and port of the last run, so that an open page finds a server that was started again."""

from __future__ import annotations

import json
import os
import secrets
import socket
from contextlib import suppress
from pathlib import Path

from filelock import FileLock

from metafem._caches import cache_folder
from metafem.errors import InvalidInput

HOST = "127.0.0.1"

# Bytes of a token: no program guesses 128 bits.
TOKEN_BYTES = 16


# The lock of this run, which is held until the process ends.
_HELD: list[FileLock] = []


def token_and_port(wanted: int | None) -> tuple[str, int]:
    """Return the token, and the wanted port, that of the last run, or any that is free; keep both.

    They are kept in the cache folder, readable by the user alone. Where that is impossible, they are new. Of
    several runs at once, the first alone has the port of the last run and keeps its own.
    """
    token, last = _kept()
    first = wanted is not None or _is_first()
    port = _free(wanted) if wanted is not None else _first_free(last if first else 0)
    with suppress(OSError):
        _keep(token, port if first else last)
    return token, port


def _is_first() -> bool:
    """Whether no other run holds the lock, which this one then does."""
    try:
        path = cache_folder() / "explorer.lock"
        path.parent.mkdir(parents=True, exist_ok=True)
        lock = FileLock(path)
        lock.acquire(timeout=0.0)
    except OSError:  # another run holds it, or it cannot be made
        return False
    _HELD.append(lock)
    return True


def _kept() -> tuple[str, int]:
    """Return token and port of the last run; a new token and port 0 if there is none."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        record = json.loads(_file().read_text("utf-8"))
        token, port = record["token"], record["port"]
        if isinstance(token, str) and len(token) >= TOKEN_BYTES and token.isascii() and isinstance(port, int):
            return token, port
    return secrets.token_hex(TOKEN_BYTES), 0


def _keep(token: str, port: int) -> None:
    path = _file()
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f"{path.name}.{secrets.token_hex(4)}")
    with os.fdopen(os.open(fresh, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(json.dumps({"token": token, "port": port}))
    fresh.replace(path)


def _file() -> Path:
    return cache_folder() / "explorer.json"


def _first_free(port: int) -> int:
    try:
        return _free(port)
    except InvalidInput:  # in use by another explorer
        return _free(0)


def _free(port: int) -> int:
    """Return a port at which nothing listens: this one, or any for 0."""
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, port))
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InvalidInput(f"port = {port} cannot be used: {reason}; omit it to use a free one") from None
        return int(trial.getsockname()[1])
