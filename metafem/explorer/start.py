"""Start of the explorer."""

from __future__ import annotations

import secrets
import socket
from pathlib import Path

from metafem import _validate as check
from metafem.errors import InvalidInput, refuse_missing
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
        Port of the server; default: any free port.
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

    serve(first, HOST, secrets.token_hex(TOKEN_BYTES), free_port(port or 0), show)


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


def free_port(wanted: int = 0) -> int:
    """Return a port or, for 0, any free port; raise InvalidInput if the port cannot be used."""
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, wanted))
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or str(error)
            raise InvalidInput(
                f"port = {wanted} cannot be used: {reason}; omit it to use a free one"
            ) from None
        return int(trial.getsockname()[1])
