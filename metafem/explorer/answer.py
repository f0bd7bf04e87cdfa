"""The answer to a state: the design of its specification, or what is wrong with it."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from metafem._validate import FloatArray
from metafem.errors import Infeasible, InvalidInput, MetafemError
from metafem.explorer.session import State
from metafem.files import Specification, read_spec
from metafem.inversion import Design


@dataclass(frozen=True, eq=False)
class Answer:
    """What a page shows of a state.

    Attributes
    ----------
    number : int
        Number of the request.
    state : State
    specification : Specification or None
        None if the text has problems.
    design : Design or None
        The last surface that was found, also where this state has problems or is refused.
    problems : mapping of str to str
        What is wrong with a key of the specification, "" for the file as a whole.
    refusal : str
        Why no surface reaches the target; "" if one does.
    nearest : tuple of ndarray or None
        Rescaled load and friction [mm^2] of the nearest law that can be designed, where one is known.
    milliseconds : float
        Duration of the computation.
    """

    number: int
    state: State
    specification: Specification | None = None
    design: Design | None = None
    problems: Mapping[str, str] = field(default_factory=dict)
    refusal: str = ""
    nearest: tuple[FloatArray, FloatArray] | None = None
    milliseconds: float = 0.0

    @property
    def current(self) -> bool:
        """Whether the design is that of the state."""
        return self.design is not None and not self.problems and not self.refusal


def answered(state: State, number: int, before: Answer | None = None) -> Answer:
    """Return the answer to a state; the design of the answer before stays where there is no new one."""
    start = time.perf_counter()
    specification, design = None, None if before is None else before.design
    problems: dict[str, str] = {}
    refusal, nearest = "", None
    try:
        specification = _specification(state)
        design = specification.design()
    except InvalidInput as error:
        problems[""] = str(error)
    except Infeasible as error:
        refusal = str(error)
        if error.nearest is not None and error.nearest.curve() is not None:
            law = error.nearest.curve()
            nearest = law.load, law.base
    except MetafemError as error:
        problems[""] = str(error)
    elapsed = 1e3 * (time.perf_counter() - start)
    return Answer(number, state, specification, design, problems, refusal, nearest, elapsed)


def _specification(state: State) -> Specification:
    with TemporaryDirectory() as folder:
        path = Path(folder, "spec.toml")
        path.write_bytes(state.text.encode("utf-8"))
        for name, text in state.tables.items():
            Path(folder, name).write_bytes(text.encode("utf-8"))
        return read_spec(path)
