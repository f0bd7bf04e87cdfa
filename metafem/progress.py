"""What a long computation is doing, for whoever listens: a terminal, a notebook, a log."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TypeVar

__all__ = ["listening"]

Item = TypeVar("Item")

# Called with the step in words, and the share of it that is done where that is known.
OnStep = Callable[[str, float | None], None]


@dataclass(frozen=True)
class _Step:
    """A step; one of a count, `of` them or at most so many, where it is repeated."""

    name: str
    number: int = 0
    of: int = 0
    at_most: bool = False

    def __str__(self) -> str:
        most = "at most " if self.at_most else ""
        return f"{self.name} {self.number} of {most}{self.of}" if self.of else self.name


@dataclass(eq=False)
class _Listener:
    """The steps that are under way, outermost first, and who is told of them."""

    on_step: OnStep
    on_fact: Callable[[str], None] | None
    steps: list[_Step] = field(default_factory=list)

    def at(self, depth: int, *step: _Step) -> None:
        """Replace the steps from a depth on, and tell what is under way."""
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
def listening(on_step: OnStep, on_fact: Callable[[str], None] | None = None) -> Iterator[None]:
    """Hear what metafem computes within the block.

    Parameters
    ----------
    on_step : callable
        Called as each step begins, with the step in words and the share that is done, from 0 to 1, or None
        where it is not known. Quick computations report many steps a second.
    on_fact : callable, optional
        Called with what should stay readable, such as where a solution is kept.

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
    token = _LISTENER.set(_Listener(on_step, on_fact))
    try:
        yield
    finally:
        _LISTENER.reset(token)


@contextmanager
def doing(name: str) -> Iterator[None]:
    """Report a step for as long as the block runs."""
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
    """Yield items and report each as a step of that name; `at_most` where the loop may end early."""
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
        listener.at(depth)


def fact(text: str) -> None:
    """Report what should stay readable after the step has ended."""
    listener = _LISTENER.get()
    if listener is not None and listener.on_fact is not None:
        listener.on_fact(text)
