"""How sure the design is, in a browser."""

from metafem.explorer.answer import answered
from metafem.explorer.certainty import numbers_of
from metafem.explorer.history import State


def test_the_numbers_are_those_of_the_specification_and_follow_it(visit):
    page = visit.page
    page.get_by_role("tab", name="How sure").click()
    for right in (0, 12):
        if right:
            visit.drag("point-1", right, -right)
        answer = answered(State(visit.text), 1)
        for name, value in numbers_of(answer, answer.design):
            page.locator(".sure-figures tr", has_text=name).get_by_text(value).wait_for()
