"""Progress of long computations, reported to a terminal, a notebook or a log."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

__all__ = ["listening"]

Item = TypeVar("Item")

# Function that is called with the name of a step and the completed fraction, or None if it is not known.
OnStep = Callable[[str, float | None], None]


# A running step: its name and, in a series, the completed fraction, or None if the series may end early.
Step = tuple[str] | tuple[str, float | None]

# Functions that report steps and messages, and the running steps, outermost first; None if nothing listens.
_LISTENER: ContextVar[tuple[OnStep, Callable[[str], None] | None, list[Step]] | None]
_LISTENER = ContextVar("metafem progress", default=None)


@contextmanager
def listening(on_step: OnStep, on_message: Callable[[str], None] | None = None) -> Iterator[None]:
    """Report the progress of computations in the ``with`` block.

    Parameters
    ----------
    on_step : callable
        Called at the start of each step with the name of the step and the completed fraction, from 0 to 1, or
        None if the fraction is not known. Fast computations report many steps per second.
    on_message : callable, optional
        Called with messages that should stay on the screen, such as the file in which a solution is stored.

    Returns
    -------
    context manager

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
    >>> steps = []
    >>> with mf.progress.listening(lambda step, done: steps.append(step)):
    ...     _ = mf.design(mf.LinearLaw(6.87), template)
    >>> steps[0], steps[-1]
    ('inverting the law', 'computing the law of the heights')
    """
    token = _LISTENER.set((on_step, on_message, []))
    try:
        yield
    finally:
        _LISTENER.reset(token)


def _report() -> None:
    """Report the running steps, if something listens."""
    if (listener := _LISTENER.get()) is not None and listener[2]:
        on_step, _, steps = listener
        done = next((step[1] for step in steps if len(step) > 1), None)
        on_step(", ".join(step[0] for step in steps), done)


@contextmanager
def _step(step: Step) -> Iterator[None]:
    """Report a step that lasts as long as the ``with`` block.

    Its end is not reported: if a loop ends early, Python prints and ignores what a listener raises.
    """
    steps = [] if (listener := _LISTENER.get()) is None else listener[2]
    depth = len(steps)
    steps.append(step)
    try:
        _report()
        yield
    finally:
        del steps[depth:]


@contextmanager
def doing(name: str) -> Iterator[None]:
    """Report a step that lasts as long as the ``with`` block."""
    with _step((name,)):
        yield
    _report()


def each(name: str, items: Sequence[Item], *, at_most: bool = False) -> Iterator[Item]:
    """Yield items and report each of them as a step called `name`.

    With `at_most`, the loop may end early.
    """
    for number, item in enumerate(items):
        words = f"{name} {number + 1} of {'at most ' if at_most else ''}{len(items)}"
        with _step((words, None if at_most else number / len(items))):
            yield item
    _report()


def message(text: str) -> None:
    """Report a message that should stay on the screen after the step ends."""
    listener = _LISTENER.get()
    if listener is not None and listener[1] is not None:
        listener[1](text)
