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


@dataclass(frozen=True)
class _Step:
    """A step. In a series, it has a number; `of` is the number of steps in the series or its upper bound."""

    name: str
    number: int = 0
    of: int = 0
    at_most: bool = False

    def __str__(self) -> str:
        most = "at most " if self.at_most else ""
        counted = f" {self.number} of {most}{self.of}" if self.of else ""
        return f"{self.name}{counted}"


@dataclass(eq=False)
class _Listener:
    """The running steps, outermost first, and the functions that report them."""

    on_step: OnStep
    on_message: Callable[[str], None] | None
    steps: list[_Step] = field(default_factory=list)

    def at(self, depth: int, *step: _Step) -> None:
        """Replace the steps at `depth` and deeper, then report the running steps."""
        self.steps[depth:] = step
        if self.steps:
            self.on_step(", ".join(map(str, self.steps)), self._done())

    def _done(self) -> float | None:
        done, width, known = 0.0, 1.0, False
        for step in self.steps:
            if step.at_most:
                break
            if step.of:
                width /= step.of
                done, known = done + width * (step.number - 1), True
        return done if known else None


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
    listener.at(depth, _Step(name))
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
        for number, item in enumerate(items, 1):
            listener.at(depth, _Step(name, number, len(items), at_most))
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
