"""The server of the page, on the loopback address."""

from __future__ import annotations

import secrets
import socket
import webbrowser

from metafem.errors import InvalidInput
from metafem.explorer.access import Guard
from metafem.explorer.session import State

HOST = "127.0.0.1"


def serve(first: State, port: int | None, show: bool) -> None:
    """Serve pages that begin with a state, until Ctrl-C."""
    port = free_port(port)
    token = secrets.token_urlsafe(16)
    address = f"http://{HOST}:{port}/?token={token}"
    from nicegui import app, ui

    from metafem.explorer.page import build

    def root() -> None:
        build(first)

    def started() -> None:
        print(f"metafem explores at {address}\nPress Ctrl-C to end.", flush=True)
        if show:
            webbrowser.open(address)

    app.add_middleware(Guard, token=token, port=port)
    app.on_startup(started)
    ui.run(
        root, host=HOST, port=port, title="metafem", dark=None, reload=False, show=False,
        show_welcome_message=False, favicon="◠", reconnect_timeout=30.0, tailwind=False,
    )  # fmt: skip


def free_port(wanted: int | None) -> int:
    """Return a port that nothing listens at: the wanted one, or any."""
    with socket.socket() as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((HOST, wanted or 0))
        except OSError as error:
            raise InvalidInput(
                f"port = {wanted} cannot be used: {error.strerror}; omit it to use a free one"
            ) from None
        return int(trial.getsockname()[1])
