"""Long computations of a page, each in a separate process that can be stopped.

Each process is a new interpreter, because a fork of the server would copy the locks of its threads. It ends
when the server ends or is killed, because its input then closes.
"""

from __future__ import annotations

import asyncio
import atexit
import logging
import os
import pickle
import subprocess
import sys
import tempfile
import threading
import weakref
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any

from metafem.errors import MetafemError
from metafem.explorer.certainty.worker import DONE, STEP, main
from metafem.explorer.queue import in_words

# Program errors are written to the terminal with their traceback.
LOG = logging.getLogger(__name__)

OnStep = Callable[[str, float | None], None]
OnDone = Callable[[Any], None]
OnError = Callable[[MetafemError], None]


def nothing(*_: Any) -> None:
    """Ignore a report."""


class Background:
    """One call of a function in a separate process, which starts when the object is created.

    The function must be importable, and its arguments and result picklable. The callbacks run in the event
    loop in which the object is created: `on_step` with the name of each step and the completed fraction, then
    once either `on_done` with the result or `on_error` with the error. No callback runs after `stop`.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        given: tuple[Any, ...],
        on_step: OnStep = nothing,
        on_done: OnDone = nothing,
        on_error: OnError = nothing,
    ) -> None:
        self.on_step, self.on_done, self.on_error = on_step, on_done, on_error
        self.running = True
        self._loop = asyncio.get_running_loop()
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        _ALL.add(self)
        self._thread = threading.Thread(target=self._run, args=(function, given), daemon=True)
        self._thread.start()

    @property
    def process_id(self) -> int | None:
        """Process ID; None before the process has started."""
        return None if self._process is None else self._process.pid

    def stop(self) -> None:
        """End the process; this method may be called at any time, and more than once."""
        with self._lock:
            self.running = False
            if self._process is not None and self._process.returncode is None:
                self._process.kill()

    def _run(self, function: Callable[..., Any], given: tuple[Any, ...]) -> None:
        """Start the process, and pass its messages to the callbacks."""
        try:
            request = pickle.dumps((function, given))
            with self._lock:
                if not self.running:
                    return
                self._process = process = subprocess.Popen(
                    [sys.executable, "-c", _program()], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                    cwd=_folder(), start_new_session=True,  # Ctrl-C in the terminal reaches only the server
                )  # fmt: skip
        except (OSError, pickle.PicklingError, TypeError, AttributeError) as error:
            self._report(self._end, self.on_error, MetafemError(f"no process could be started: {error}"))
            return
        # closing the input flushes the rest of the request, which fails if the process has ended
        with suppress(BrokenPipeError), process:
            self._exchange(process, request)
            process.kill()

    def _exchange(self, process: subprocess.Popen[bytes], request: bytes) -> None:
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(request)
            process.stdin.flush()
            while True:
                kind, value = pickle.load(process.stdout)
                if kind != STEP:
                    break
                self._report(self._step, *value)
        except (OSError, EOFError, pickle.UnpicklingError, AttributeError, ImportError, TypeError):
            code = process.wait()
            ended = MetafemError(
                f"the process of the computation ended before its result (exit code {code}), for example for "
                "lack of memory; start it again, with fewer asperities or draws"
            )
            self._report(self._end, self.on_error, ended)
        else:
            self._report(self._end, self.on_done if kind == DONE else self.on_error, value)

    def _report(self, function: Callable[..., None], *given: Any) -> None:
        """Call a function in the event loop, if the loop still runs."""
        try:
            self._loop.call_soon_threadsafe(partial(function, *given))
        except RuntimeError:  # the loop is closed
            self.running = False

    def _step(self, name: str, done: float | None) -> None:
        if self.running:
            self._told(self.on_step, name, done)

    def _end(self, function: Callable[[Any], None], value: Any) -> None:
        if self.running:
            self.running = False
            self._told(function, value)

    def _told(self, function: Callable[..., None], *given: Any) -> None:
        """Call a callback of the page; if it fails, stop the computation and report the error."""
        try:
            function(*given)
        except Exception as error:
            LOG.exception("what a computation sent was not shown")
            self.stop()
            if function is not self.on_error:
                self.on_error(MetafemError(in_words(error)))


class Tasks:
    """The background computations of a page, at most one for each name."""

    def __init__(self) -> None:
        self._tasks: dict[str, Background] = {}

    def start(
        self,
        name: str,
        function: Callable[..., Any],
        given: tuple[Any, ...],
        on_step: OnStep = nothing,
        on_done: OnDone = nothing,
        on_error: OnError = nothing,
    ) -> Background:
        """Start a computation, and stop the previous one with the same name; arguments as in `Background`."""
        self.stop(name)
        self._tasks[name] = Background(function, given, on_step, on_done, on_error)
        return self._tasks[name]

    def running(self, name: str) -> bool:
        """Return whether the computation with this name is running."""
        return name in self._tasks and self._tasks[name].running

    def stop(self, name: str) -> None:
        """Stop the computation with this name, if there is one."""
        if name in self._tasks:
            self._tasks.pop(name).stop()

    def stop_all(self) -> None:
        """Stop all computations, because the page was closed."""
        for name in tuple(self._tasks):
            self.stop(name)


_ALL: weakref.WeakSet[Background] = weakref.WeakSet()


@atexit.register
def _stop_every_one() -> None:
    for task in tuple(_ALL):
        task.stop()


def _folder() -> str | None:
    """Return the working folder for a new process: None for the current one, or another if it was removed."""
    try:
        os.getcwd()
    except OSError:
        return tempfile.gettempdir()
    return None


def _program() -> str:
    """Return the Python code of a process, which searches modules in the same paths as this process."""
    return f"import sys; sys.path[:] = {sys.path!r}; from {main.__module__} import main; main()"
