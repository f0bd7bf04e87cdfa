"""The answer to a state: the design of its specification, or what is wrong with it."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from metafem._validate import FloatArray
from metafem.errors import Infeasible, InvalidInput, MetafemError
from metafem.explorer.session import State
from metafem.files import Specification, parsed, section_forms
from metafem.inversion import Design, OperatingPoints, SampledLaw
from metafem.inversion.targets.target import Target
from metafem.inversion.targets.wording import Wording


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
    reasons : mapping of str to str
        The problems without their keys and values, where these stand beside them.
    refusal : str
        Why no surface reaches the target; "" if one does.
    nearest : tuple of ndarray or None
        Rescaled load and friction [mm^2] of the nearest law that can be designed, where one is known.
    nearest_target : Target or None
        The target of that law.
    milliseconds : float
        Duration of the computation.
    draft : bool
        Whether the design is that of a quick search, while a handle is moved.
    undecided : bool
        Whether a draft has found no surface although no bound excludes one: the whole search decides.
    failed : bool
        Whether the computation failed for a specification that may be correct.
    """

    number: int
    state: State
    specification: Specification | None = None
    design: Design | None = None
    problems: Mapping[str, str] = field(default_factory=dict)
    refusal: str = ""
    nearest: tuple[FloatArray, FloatArray] | None = None
    milliseconds: float = 0.0
    nearest_target: Target | None = None
    draft: bool = False
    failed: bool = False
    undecided: bool = False
    reasons: Mapping[str, str] = field(default_factory=dict)

    @property
    def current(self) -> bool:
        """Whether the design is that of the state, or a draft of it."""
        return self.design is not None and not self.problems and not self.refusal

    @property
    def refused(self) -> str:
        """Why there is no design of the state, in words; "" if there is one."""
        return self.refusal or "\n".join(self.problems.values())


def answered(state: State, number: int, before: Answer | None = None, draft: bool = False) -> Answer:
    """Return the answer to a state; the design of the answer before stays where there is no new one.

    A draft is the design of a quick search. Where that finds none although no bound excludes the target, the
    answer is undecided, so that a draft refuses nothing for good that can be designed.
    """
    start = time.perf_counter()
    if before is not None and before.current and _serves(before, state, draft):
        elapsed = 1e3 * (time.perf_counter() - start)
        return replace(before, number=number, state=state, milliseconds=elapsed)
    specification, design = None, None if before is None else before.design
    problems: dict[str, str] = {}
    reasons: dict[str, str] = {}
    refusal, nearest, nearest_target, failed, undecided = "", None, None, False, False
    try:
        specification = specification_of(state)
        design = specification.design(draft=draft)
    except InvalidInput as error:
        problems, reasons = _problems(error)
    except Infeasible as error:
        refusal = str(error) if specification is None else _in_units_of(state, specification, error)
        undecided = draft and error.by_search
        if specification is not None and error.nearest is not None:
            nearest_target = error.nearest
            nearest = _law_of(specification, error.nearest, draft)
    except MetafemError as error:
        problems[""], failed, undecided = str(error), True, draft
    elapsed = 1e3 * (time.perf_counter() - start)
    return Answer(
        number, state, specification, design, problems, refusal, nearest, elapsed, nearest_target, draft,
        failed, undecided, reasons,
    )  # fmt: skip


def specification_of(state: State) -> Specification:
    """Return the specification of a state, or raise InvalidInput."""
    # half a pair of surrogates, which a browser can send, is then refused as not UTF-8
    tables = {name: text.encode("utf-8", "surrogatepass") for name, text in state.tables.items()}
    return parsed(state.text, tables)


def _in_units_of(state: State, specification: Specification, error: Infeasible) -> str:
    """Return a refusal of points in the unit of the axes."""
    target, template = specification.target, specification.template
    if template.friction is None or not isinstance(target, (OperatingPoints, SampledLaw)):
        return str(error)
    return error.in_units(Wording.of(template.material, template.friction) if state.newtons else Wording())


def _serves(before: Answer, state: State, draft: bool) -> bool:
    """Whether the design of an answer is that of another state, too."""
    return before.state.designs_the_same(state) and (draft or not before.draft)


def _problems(error: InvalidInput) -> tuple[dict[str, str], dict[str, str]]:
    """Return the problems of a refused specification by their keys, with and without key and value."""
    found: dict[str, list[InvalidInput]] = {}
    for problem in error.problems or (error,):
        found.setdefault(_known(problem.key), []).append(problem)
    problems = {key: "\n".join(map(str, each)) for key, each in found.items()}
    return problems, {key: _reason(key, each) for key, each in found.items()}


def _known(key: str) -> str:
    """Return a key, or the longest part of it that a specification can have: "" for none."""
    forms = section_forms()
    known = {f"{form.name}.{key.name}" for form in forms for keys in form.keys.values() for key in keys}
    known |= {name for form in forms for name in (form.name, f"{form.name}.kind")}
    key = key.partition("[")[0]
    while key and key not in known:
        key = key.rpartition(".")[0]
    return key


def _reason(key: str, problems: Sequence[InvalidInput]) -> str:
    """Return what is wrong with a key where its name and value stand beside it, as a sentence."""
    if len(problems) > 1 or "." not in key or key != problems[0].key:
        return "\n".join(map(str, problems))
    words = problems[0].must
    return f"{words[:1].upper()}{words[1:]}."


def _law_of(
    specification: Specification, target: Target, draft: bool
) -> tuple[FloatArray, FloatArray] | None:
    """Return the law of a target; where only slopes are given, that of its design."""
    try:
        law = target.curve()
        if not law.is_open:
            return law.load, law.base
    except InvalidInput:
        pass  # a target without a range of loads, whose law depends on the surface
    try:
        found = replace(specification, target=target).design(draft=draft).law
    except MetafemError:
        return None
    return found.rescaled_load, found.rescaled_friction
