"""The server of the page, on the loopback address."""

from __future__ import annotations

import asyncio
import gc
import webbrowser

from metafem.errors import InvalidInput
from metafem.explorer.access import Guard
from metafem.explorer.last_run import HOST, token_and_port
from metafem.explorer.session import State

# Time for which the server holds a page after its connection is lost [s]. A later reconnection loads the page
# again, with the state that the browser stored.
RECONNECTION = 10.0

# Interval between checks whether the server has started [s]. The address is printed only after the start.
POLLED = 0.01

# Exit code of uvicorn if it cannot listen at the port.
STARTUP_FAILURE = 3

# Number of messages that are sent again after a lost connection. A step of a drag sends two of about 20 kB.
HISTORY = 100


def serve(first: State, port: int | None, show: bool) -> None:
    """Serve pages that begin with a state, until Ctrl-C."""
    token, port = token_and_port(port)
    address = f"http://{HOST}:{port}/{token}/"
    from nicegui import app, background_tasks, ui
    from nicegui.server import Server

    from metafem.explorer.answer import answered
    from metafem.explorer.page import build

    def root() -> None:
        build(first)

    async def announce() -> None:
        while not Server.instance.started:
            await asyncio.sleep(POLLED)
        print(f"Open {address} in a browser of this machine.\nPress Ctrl-C to end.", flush=True)
        if show:
            webbrowser.open(address)

    async def warm_up() -> None:
        # a draft loads the compiled kernels while the browser loads the page; a design could take long
        await asyncio.to_thread(answered, first, 0, draft=True)
        gc.freeze()  # the modules stay; looking through them for garbage would hold up a drag for .1 s

    app.add_middleware(Guard, token=token, port=port)
    app.on_startup(lambda: background_tasks.create(announce()))
    app.on_startup(lambda: background_tasks.create(warm_up()))
    try:
        ui.run(
            root, host=HOST, port=port, title="metafem", dark=None, language="en-US", reload=False,
            show=False, show_welcome_message=False, favicon="◠", reconnect_timeout=RECONNECTION,
            tailwind=False, message_history_length=HISTORY, binding_refresh_interval=None,
        )  # fmt: skip
    except SystemExit as end:
        if end.code != STARTUP_FAILURE:
            raise
        taken = f"port = {port} was taken by another program in the meantime; run the command again"
        raise InvalidInput(taken) from None
