"""Token and port of the last run, so that an open page finds the server after a restart."""

from __future__ import annotations

import json
import os
import secrets
import socket
from contextlib import suppress
from pathlib import Path

from metafem._caches import cache_folder
from metafem.errors import InvalidInput

HOST = "127.0.0.1"

# Length of a token [bytes]. No program can guess 16 bytes (128 bits).
TOKEN_BYTES = 16


def token_and_port(wanted: int | None) -> tuple[str, int]:
    """Return token and port for this run, and save both for the next run.

    The port is `wanted` or, if this is None, the port of the last run or any free port. Token and port are
    saved in the cache folder in a file that only the user can read; if that is impossible, each run has new
    ones. A run beside the last one, whose port is in use, does not save its own, unless it is `wanted`.
    """
    token, last = _kept()
    port = _free(wanted) if wanted is not None else _first_free(last)
    with suppress(OSError):
        _keep(token, port if wanted is not None or last == 0 else last)
    return token, port


def _kept() -> tuple[str, int]:
    """Return token and port of the last run; without a usable record, a new token and port 0."""
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
    """Return `port` or, if it is 0, any free port; raise InvalidInput if the port cannot be used."""
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, port))
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InvalidInput(f"port = {port} cannot be used: {reason}; omit it to use a free one") from None
        return int(trial.getsockname()[1])
