"""The answer to a state of the page: the design of its specification, or the problems in it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

from metafem._validate import FloatArray
from metafem.errors import Infeasible, InvalidInput, MetafemError
from metafem.explorer.fields import shown
from metafem.explorer.history import State
from metafem.explorer.table import on_page, places
from metafem.files import Specification, of_table, planned, toml_table
from metafem.inversion import Design, Target
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.files.part import Part

# Largest number of asperities whose interaction is computed while a handle is dragged. On two cores a draft
# under "layer" takes 20 to 150 ms for 64 asperities and 130 to 1300 ms for 400; without interaction it takes
# 15 to 90 ms for 400, and its law differs by 1 to 8 %. That of adhesive asperities is never computed: for 64
# of them a draft takes 2 to 13 s with interaction, and 30 to 160 ms without.
MOST_DRAFTED = 100

# The entry of a list behind its key, or nothing.
ENTRY = re.compile(r"(?:\[(\d+)\](?:\[\d+\])*)?")


@dataclass(frozen=True, eq=False)
class Answer:
    """What the page shows for a state.

    Attributes
    ----------
    number : int
        Number of the request.
    state : State
    specification : Specification or None
        None if the text has problems.
    design : Design or None
        The design of this state; if this state has problems or is refused, the last design found before it.
    problems : mapping of str to str
        Error messages by key of the specification; the key "" is for the whole file.
    reasons : mapping of str to str
        The same messages by key in the words of the page, without key and value, which the field shows.
    offers : mapping of str to str
        Example values by key, as a field shows them, of those of these messages that have one.
    refusal : str
        Why no surface reaches the target; "" if a surface does.
    nearest : tuple of ndarray or None
        Rescaled load and friction [mm^2] of the nearest law that can be designed; None if it is not known.
    nearest_target : Target or None
        The target that has this nearest law.
    draft : bool
        Whether the design comes from the quick search that runs while the user drags a handle.
    undecided : bool
        Whether a draft found no surface although no bound excludes one. The full search then decides.
    failed : bool
        Whether the computation failed although the specification may be correct.
    stopped : bool
        Whether the user has stopped the computation, so that there is no design or only a draft.
    """

    number: int
    state: State
    specification: Specification | None = None
    design: Design | None = None
    problems: Mapping[str, str] = field(default_factory=dict)
    refusal: str = ""
    nearest: tuple[FloatArray, FloatArray] | None = None
    nearest_target: Target | None = None
    draft: bool = False
    failed: bool = False
    undecided: bool = False
    reasons: Mapping[str, str] = field(default_factory=dict)
    offers: Mapping[str, str] = field(default_factory=dict)
    stopped: bool = False

    @property
    def current(self) -> bool:
        """Whether the design, full or draft, belongs to this state and not to an earlier one."""
        return self.design is not None and not self.problems and not self.refusal

    @property
    def simplified(self) -> bool:
        """Whether the design is a draft under a simpler model than that of the specification."""
        if self.design is None or self.specification is None or not self.current:
            return False
        return self.design.law.model != self.specification.model

    @property
    def template(self) -> Surface | None:
        """The template of this state or, if its text has problems, of the last design."""
        known = self.design if self.specification is None else self.specification
        return None if known is None else known.template

    @property
    def refused(self) -> str:
        """Why this state has no design, in the words of the page; "" if it has one."""
        return self.refusal or on_page("\n".join(self.problems.values()))

    @cached_property
    def part(self) -> Part | InvalidInput | None:
        """The part of the design, or why it cannot be made; None without a block or a current design."""
        design, specification = self.design, self.specification
        if not self.current or design is None or specification is None:
            return None
        try:
            return planned(design.surface, design.template, specification.part)
        except InvalidInput as error:
            return error.with_traceback(None)  # which would keep this answer

    @property
    def no_part(self) -> str:
        """Why the part cannot be made, in the words of the page; "" if there is no such reason."""
        return on_page(f"no part can be made: {self.part}") if isinstance(self.part, InvalidInput) else ""


def answered(
    state: State, number: int, before: Answer | None = None, draft: bool = False, stopped: bool = False
) -> Answer:
    """Return the answer to a state; if no design is found, it contains the design of the answer `before`.

    A draft is designed by a quick search, under the model that `_drafted` chooses. If the quick search finds
    no design although no bound excludes the target, the answer is undecided: the full search may still find a
    design. If the computation was stopped, a draft or no design is enough.
    """
    if before is not None and _serves(before, state, draft or stopped):
        return replace(before, number=number, state=state, stopped=stopped and before.draft)
    answer = Answer(number, state, None, before.design if before else None, draft=draft)
    try:
        specification = specification_of(state)
        answer = replace(answer, specification=specification)
        if stopped:
            return replace(answer, design=None, stopped=True)
        return replace(answer, design=_designed(specification, draft))
    except InvalidInput as error:
        return replace(answer, **_problems(error))  # type: ignore[arg-type]
    except Infeasible as error:
        return _refused(answer, error)
    except MetafemError as error:
        return replace(answer, problems={"": str(error)}, failed=True, undecided=draft)


def _refused(answer: Answer, error: Infeasible) -> Answer:
    """Return an answer with the reason why no surface reaches the target, and the nearest law."""
    given, draft = answer.specification, answer.draft
    answer = replace(answer, undecided=draft and error.by_search, nearest_target=error.nearest)
    nearest = None
    if given is not None and error.nearest is not None:
        nearest = _law_of(given, error.nearest, draft)
    return replace(answer, refusal=on_page(str(error)), nearest=nearest)


def specification_of(state: State) -> Specification:
    """Return the specification of a state, or raise InvalidInput."""
    # a browser can send a lone surrogate; with "surrogatepass" the reader then refuses it as invalid UTF-8
    tables = {name: text.encode("utf-8", "surrogatepass") for name, text in state.tables.items()}
    return of_table(state.table, state.text, tables)


def _designed(specification: Specification, draft: bool) -> Design:
    """Return the design of a specification; a draft is under the model that `_drafted` chooses."""
    return specification.design(_drafted(specification) if draft else None, draft=draft)


def _drafted(specification: Specification) -> Model:
    """Return the model of a draft: with sensitivities; without interaction of many or adhesive ones."""
    model, contact = specification.model, contact_of(specification.model)
    if model.couples and (specification.template.count > MOST_DRAFTED or contact.adhesive):
        return Independent(contact)
    return model.gradient_model


def _serves(before: Answer, state: State, draft: bool) -> bool:
    """Return whether an earlier answer, with another number, is also the answer to this state."""
    same = (
        before.state.designs_the_same(state) if before.current else before.refused and before.state == state
    )
    return bool(same) and (draft or not before.draft)


def _problems(error: InvalidInput) -> dict[str, dict[str, str]]:
    """Return the problems of a specification by key, as members of an answer.

    An example can be a line with another key of the section. One for an entry would replace its whole list,
    and that of a file is not loaded.
    """
    problems, reasons, offers = dict[str, str](), dict[str, str](), dict[str, str]()
    for each in error.problems or (error,):
        key = _known(each.key)
        section, _, name = key.rpartition(".")
        line = each.example if " = " in each.example else f"{name} = {each.example}" * bool(each.example)
        examples = {f"{section}.{other}": shown(value) for other, value in toml_table(line).items()}
        words = on_page(_sentence(key, each, ", ".join(examples.values())))
        problems[key] = f"{problems[key]}\n{each}" if key in problems else str(each)
        reasons[key] = f"{reasons[key]}\n{words}" if key in reasons else words
        if each.key == key and name != "file":
            offers |= examples
    return {"problems": problems, "reasons": reasons, "offers": offers}


def _known(key: str) -> str:
    """Return the longest leading part of a key that a specification can have; "" if there is none."""
    key = key.partition("[")[0]
    while key and places().get(key) != key:
        key = key.rpartition(".")[0]
    return key


def _sentence(key: str, problem: InvalidInput, example: str) -> str:
    """Return a problem as a sentence; without the key if its field shows it, and with the entry of a list."""
    if "." not in key:
        return str(problem)
    words, place = str(problem.args[0]), ENTRY.fullmatch(problem.key.removeprefix(key))
    words += f"; write for example {example}" * bool(example)
    if words.startswith("and ") or place is None:
        return f"{problem}."
    if place[1]:
        value = "" if problem.value is None else f" = {problem.value}"
        words = f"entry {int(place[1]) + 1}{value} {words}"
    return f"{words[:1].upper()}{words[1:]}."


def _law_of(
    specification: Specification, target: Target, draft: bool
) -> tuple[FloatArray, FloatArray] | None:
    """Return rescaled load and friction (k,) [mm^2] of the law of a target.

    If the target has open parameters or no load range, the law of its design is returned, or None if there is
    no such design.
    """
    law = target.curve()  # None without a range of loads, where the law depends on the surface
    if law is not None and not law.is_open:
        return law.load, law.middle
    try:
        found = _designed(replace(specification, target=target), draft).law
    except MetafemError:
        return None
    return found.rescaled_load, found.rescaled_friction
