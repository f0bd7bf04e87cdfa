"""Each problem of a specification leads to its line."""

import re

import pytest

from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.workshop.editor import placed
from metafem.files import demo_text

TEXT = demo_text("linear")


def line_of(text, key):
    """Return the line number of a problem at a key."""
    return placed(text, {key: "is wrong"})[0]["line"]


@pytest.mark.parametrize(
    ("change", "line", "key"),
    [
        (('"120 um"', "120"), 'max_height = 120', "limits.max_height"),
        (('max_height = "120 um"', 'top = 3'), "top = 3", "limits"),
        (("[limits]", "[limits"), "[limits", ""),
        (('kind = "linear"', 'kind = "linar"'), 'kind = "linar"', "target.kind"),
    ],
)  # fmt: skip
def test_the_line_of_a_problem_is_the_one_that_was_changed(change, line, key):
    text = TEXT.replace(*change)
    answer = answered(State(text), 1)
    found = placed(text, answer.problems)
    at = next(problem for problem in found if problem["key"] == key)["line"]
    assert text.splitlines()[at - 1].startswith(line)


def test_all_keys_of_a_text_are_found_in_their_order():
    keys = [(1, "target.kind"), (2, "a.b"), (4, "a"), (6, "contact.cap.kind")]
    text = 'target.kind = "linear"\na.b = 1\n# a.c = 2\n[a]\n[contact.cap]\nkind = "hertz"\n'
    assert [line_of(text, key) for _, key in keys] == [line for line, _ in keys]
    assert line_of(text, "a.c") == 4
    assert line_of(text, "limits.offset") == 0


def test_many_problems_are_placed_at_once():
    text = "".join(f"[k{i}]\n" for i in range(4000))
    problems = {"": "\n".join(f"k{i}.a is unknown" for i in range(4000))}
    assert [each["line"] for each in placed(text, problems)] == list(range(1, 4001))


def test_a_missing_section_has_no_line():
    text = re.sub(r"(?s)\[material\].*?\n\n", "", TEXT)
    (problem,) = placed(text, answered(State(text), 1).problems)
    assert (problem["line"], problem["key"]) == (0, "material")


def test_a_refusal_belongs_to_the_target():
    (problem,) = placed(TEXT, {}, "slope 2 is not above the bound")
    assert TEXT.splitlines()[problem["line"] - 1] == "[target]"
