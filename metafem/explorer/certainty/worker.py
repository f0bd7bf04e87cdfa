"""What a background process does: one call, whose steps and result it sends to the process that waits."""

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

# Seconds between two reports of progress; a page shows no more of them.
SHOWN_EVERY = 0.25

# Niceness of the process: the page, whose designs are awaited at every move of a point, comes first.
NICENESS = 5

STEP, DONE, FAILED = "step", "done", "failed"


def main() -> None:
    """Read a function and its arguments, and write its steps and its result or error."""
    requests, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what the function prints is no answer
    if sys.platform != "win32":  # which has no niceness
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
    """Return that a function is done, and its result; or that it failed, and a MetafemError."""
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
    content = pickle.dumps((kind, value))  # whole, before a byte of it is written
    answers.write(content)
    answers.flush()


def _end_with_parent(requests: BinaryIO) -> None:
    """End this process when the one that started it has ended, and its end of the pipe with it."""
    requests.read()
    os._exit(1)
