"""Program of a background process: it calls one function and sends its progress and result to the server."""

from __future__ import annotations

import os
import pickle
import sys
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any, BinaryIO

from metafem.errors import MetafemError
from metafem.progress import listening

# Shortest time between two progress reports [s]. The page needs no more.
SHOWN_EVERY = 0.25

# Niceness of the process. The server has a higher priority: it computes a design at every step of a drag.
NICENESS = 5

STEP, DONE, FAILED = "step", "done", "failed"


def main() -> None:
    """Read a function and its arguments, call the function, and write its steps and its result or error."""
    requests, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # printed output must not mix with the answers
    if sys.platform != "win32":  # Windows has no niceness
        os.nice(NICENESS)
    function, given = pickle.load(requests)
    threading.Thread(target=_end_with_parent, args=(requests,), daemon=True).start()
    kind, value = computed(function, given, lambda *step: _send(answers, STEP, step))
    try:
        _send(answers, kind, value)
    except (pickle.PicklingError, TypeError, AttributeError) as error:
        _send(answers, FAILED, MetafemError(f"the result cannot be sent to the page: {error}"))


def computed(
    function: Callable[..., Any], given: tuple[Any, ...], on_step: Callable[[str, float | None], None]
) -> tuple[str, Any]:
    """Call a function; return `DONE` and its result, or `FAILED` and a MetafemError."""
    shown = -SHOWN_EVERY

    def step(name: str, done: float | None) -> None:
        nonlocal shown
        now = time.monotonic()
        if now - shown >= SHOWN_EVERY:
            shown = now
            on_step(name, done)

    try:
        with listening(step):
            return DONE, function(*given)
    except MetafemError as error:
        return FAILED, error
    except MemoryError:
        return FAILED, MetafemError("there is not enough memory for this computation")
    except Exception as error:
        traceback.print_exc()
        return FAILED, MetafemError(
            f"an error within metafem, {type(error).__name__}: {error}; the terminal shows where"
        )


def _send(answers: BinaryIO, kind: str, value: Any) -> None:
    content = pickle.dumps((kind, value))  # pickled completely before a byte is written
    answers.write(content)
    answers.flush()


def _end_with_parent(requests: BinaryIO) -> None:
    """End this process when its input closes, which happens when the server process ends."""
    requests.read()
    os._exit(1)
