"""How sure the design is, in a browser."""

from metafem.explorer.answer import answered
from metafem.explorer.certainty.figures import figures
from metafem.explorer.session import State

# Texts of the rows of the table, by their names.
ROWS = """() => Object.fromEntries([...document.querySelectorAll('tr[data-standing]')].map(row => [
  row.querySelector('th').firstChild.textContent,
  [row.dataset.standing, row.querySelector('td.number').firstChild.textContent],
]))"""


def open_tab(visit):
    visit.page.get_by_role("tab", name="How sure").click()
    visit.page.locator(".sure-figures tr[data-standing]").first.wait_for()


def test_the_figures_are_those_of_the_specification_and_have_words_for_their_states(visit):
    open_tab(visit)
    # the draws of the band have been made
    visit.page.get_by_text("Of 200 drawn surfaces with errors").wait_for()
    answer = answered(State(visit.text), 1)
    expected = {each.name: [each.standing.value, each.value] for each in figures(answer)}
    shown = {name[:1].lower() + name[1:]: row for name, row in visit.page.evaluate(ROWS).items()}
    scatter = "scatter of the law of made surfaces"
    assert shown.keys() == expected.keys()
    assert {k: v for k, v in shown.items() if k != scatter} == {
        k: v for k, v in expected.items() if k != scatter
    }
    assert visit.page.locator(".sure-figures .chip", has_text="good").count() > 3
