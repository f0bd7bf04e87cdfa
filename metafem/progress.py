"""Progress of long computations, reported to a terminal, a notebook or a log."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TypeVar

__all__ = ["listening"]

Item = TypeVar("Item")

# Function that is called with the name of a step and the completed fraction, or None if it is not known.
OnStep = Callable[[str, float | None], None]


@dataclass(eq=False)
class _Listener:
    """The functions that report steps and messages, and the running steps, outermost first.

    A step of a series has a completed fraction of it, which is None if the series may end early.
    """

    on_step: OnStep
    on_message: Callable[[str], None] | None
    steps: list[tuple[str, *tuple[float | None, ...]]] = field(default_factory=list)

    def at(self, depth: int, *step: tuple[str, *tuple[float | None, ...]]) -> None:
        """Replace the steps at `depth` and deeper, then report the running steps."""
        self.steps[depth:] = step
        if self.steps:
            done = next((step[1] for step in self.steps if len(step) > 1), None)
            self.on_step(", ".join(step[0] for step in self.steps), done)


_LISTENER: ContextVar[_Listener | None] = ContextVar("metafem progress", default=None)


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
    token = _LISTENER.set(_Listener(on_step, on_message))
    try:
        yield
    finally:
        _LISTENER.reset(token)


@contextmanager
def doing(name: str) -> Iterator[None]:
    """Report a step that lasts as long as the ``with`` block."""
    listener = _LISTENER.get()
    if listener is None:
        yield
        return
    depth = len(listener.steps)
    listener.at(depth, (name,))
    try:
        yield
    finally:
        listener.at(depth)


def each(name: str, items: Sequence[Item], *, at_most: bool = False) -> Iterator[Item]:
    """Yield items and report each of them as a step called `name`.

    With `at_most`, the loop may end early.
    """
    listener = _LISTENER.get()
    if listener is None:
        yield from items
        return
    depth = len(listener.steps)
    try:
        for number, item in enumerate(items):
            words = f"{name} {number + 1} of {'at most ' if at_most else ''}{len(items)}"
            listener.at(depth, (words, None if at_most else number / len(items)))
            yield item
    finally:
        # do not report here: if the loop ends early, Python prints and ignores exceptions raised by a
        # listener
        del listener.steps[depth:]
    listener.at(depth)


def message(text: str) -> None:
    """Report a message that should stay on the screen after the step ends."""
    listener = _LISTENER.get()
    if listener is not None and listener.on_message is not None:
        listener.on_message(text)
