"""Start of the explorer, at the address of the last run, where an open page finds it."""

from __future__ import annotations

import json
import os
import secrets
import socket
from contextlib import suppress
from pathlib import Path

from metafem import _validate as check
from metafem._caches import cache_folder
from metafem._extras import refuse_missing
from metafem.errors import InvalidInput
from metafem.explorer.history import State

__all__ = ["explore"]


def explore(path: str | Path | None = None, *, port: int | None = None, show: bool = True) -> None:
    """Open the explorer in the browser, and serve it until Ctrl-C.

    The server listens only at the loopback address of this machine, and answers only requests whose address
    contains a secret token. The complete address is printed.

    Parameters
    ----------
    path : str or Path, optional
        A specification, or a result folder with a ``spec.toml``; default: the demo ``operating-points``.
    port : int, optional
        Port of the server; default: the port of the last run, or any free port.
    show : bool
        Whether to open the browser. Default: True.

    Raises
    ------
    InvalidInput
        If the specification cannot be used, the port is in use, or the extra ``explorer`` is not installed.
    """
    refuse_missing("nicegui", "explorer", "the explorer")
    refuse_missing("rtoml", "explorer", "the explorer")
    first = first_state(path)
    if port is not None:
        check.integer("port", port, at_least=1)
    from metafem.explorer.server import serve

    serve(first, HOST, *token_and_port(port), show)


def first_state(path: str | Path | None) -> State:
    """Return the first state of a page, from a specification, a result folder or, for None, the demo."""
    from metafem.files import demo_text, read_spec

    if path is None:
        return State(demo_text("operating-points"))
    folder = Path(path)
    if folder.is_dir():
        if not (folder / "spec.toml").is_file():
            raise InvalidInput(
                f"{path} holds no spec.toml; name a specification, or a folder of `metafem design`"
            )
        folder = folder / "spec.toml"
    files = {name: content.decode("utf-8") for name, content in read_spec(folder).files.items()}
    return State(files.pop("spec.toml"), files)


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
