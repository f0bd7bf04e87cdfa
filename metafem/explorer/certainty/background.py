"""Long computations of a page, each in a separate process that can be stopped.

Each process is a new interpreter: a fork of the server would copy the locks of its threads, and a process of
`multiprocessing` would run the user's main script again. The process ends when the server ends or is killed,
because its input then closes.
"""

from __future__ import annotations

import asyncio
import os
import pickle
import sys
import tempfile
import threading
import time
import traceback
from asyncio.subprocess import PIPE
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from metafem.errors import MetafemError
from metafem.progress import listening

# Shortest time between two progress reports [s]. The page needs no more.
SHOWN_EVERY = 0.25

# Niceness of a process. The server has a higher priority: it computes a design at every step of a drag.
NICENESS = 5

# Number of bytes before each message of a process, which hold its length.
LENGTH = 8

OnStep = Callable[[str, float | None], None]


class Tasks:
    """The background computations of a page, at most one for each name."""

    def __init__(self) -> None:
        self._started: dict[str, asyncio.Task[Any]] = {}

    def start(
        self, name: str, function: Callable[..., Any], given: tuple[Any, ...], on_step: OnStep
    ) -> asyncio.Task[Any]:
        """Call a function in a process; await the task for its value or its MetafemError.

        The previous computation with the same name is stopped. A computation that is stopped raises
        CancelledError. The function must be importable, and its arguments and result picklable. `on_step` is
        called with the name of each step and the completed fraction.
        """
        self.stop(name)
        self._started[name] = asyncio.get_running_loop().create_task(_called(function, given, on_step))
        return self._started[name]

    def running(self, name: str) -> bool:
        """Return whether the computation with this name is running."""
        return name in self._started and not self._started[name].done()

    def stop(self, name: str) -> None:
        """Stop the computation with this name, if there is one."""
        if name in self._started:
            self._started.pop(name).cancel()

    def stop_all(self) -> None:
        """Stop all computations, because the page was closed."""
        for name in tuple(self._started):
            self.stop(name)


async def _called(function: Callable[..., Any], given: tuple[Any, ...], on_step: OnStep) -> Any:
    """Call a function in a process; the process ends with this coroutine, also if it is cancelled."""
    program = f"import sys; sys.path[:] = {sys.path!r}; from {__name__} import main; main()"
    try:
        request = await asyncio.to_thread(pickle.dumps, (function, given))
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-c", program, stdin=PIPE, stdout=PIPE, cwd=_folder(),
            start_new_session=True,  # Ctrl-C in the terminal reaches only the server
        )  # fmt: skip
    except (OSError, pickle.PicklingError, TypeError, AttributeError) as error:
        raise MetafemError(f"no process could be started: {error}") from None
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(request)
        while True:
            length = int.from_bytes(await process.stdout.readexactly(LENGTH), "big")
            done, value = pickle.loads(await process.stdout.readexactly(length))
            if done:
                return value
            if done is not None:
                raise value
            on_step(*value)
    except asyncio.IncompleteReadError:
        raise MetafemError(
            f"the process of the computation ended before its result (exit code {await process.wait()}), for "
            "example for lack of memory; start it again, with fewer asperities or draws"
        ) from None
    finally:
        with suppress(ProcessLookupError):  # it has ended
            process.kill()
        await process.communicate()  # reads what is left, so that the pipe closes


def _folder() -> str:
    """Return the working folder for a new process: the current one, or another if it was removed."""
    with suppress(OSError):
        return os.getcwd()
    return tempfile.gettempdir()


def main() -> None:
    """Read a function and its arguments, call the function, and write its steps and its result or error."""
    requests, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # printed output must not mix with the answers
    if sys.platform != "win32":  # Windows has no niceness
        os.nice(NICENESS)
    function, given = pickle.load(requests)
    threading.Thread(target=lambda: (requests.read(), os._exit(1)), daemon=True).start()
    shown = -SHOWN_EVERY

    def send(done: bool | None, value: Any) -> None:
        content = pickle.dumps((done, value))  # pickled completely before a byte is written
        answers.write(len(content).to_bytes(LENGTH, "big") + content)
        answers.flush()

    def step(*named: Any) -> None:
        nonlocal shown
        if time.monotonic() - shown >= SHOWN_EVERY:
            shown = time.monotonic()
            send(None, named)

    try:
        with listening(step):
            send(True, function(*given))
    except MetafemError as error:
        send(False, error)
    except MemoryError:
        send(False, MetafemError("there is not enough memory for this computation"))
    except Exception as error:
        traceback.print_exc()
        words = f"an error within metafem, {type(error).__name__}: {error}; the terminal shows where"
        send(False, MetafemError(words))
