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


def study(visit, name):
    return visit.page.locator(f'[data-study="{name}"]')


def started(visit, name):
    """Start a study, and wait until its process works."""
    study(visit, name).get_by_role("button").click()
    study(visit, name).locator(".step", has_not_text="starting a process").wait_for()
    study(visit, name).locator(".step", has_text=" ").wait_for()


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


def test_a_study_shows_its_answer_which_stays_at_a_reload_and_is_marked_after_a_change(visit):
    open_tab(visit)
    started(visit, "misalignment")
    answer = study(visit, "misalignment").locator(".answer")
    answer.wait_for()
    assert answer.inner_text().startswith("With tilts within ±0.0872° the slope scatters by less than 1 %")
    assert study(visit, "misalignment").locator("figure svg").count() == 1
    visit.page.reload()
    visit.settled()
    open_tab(visit)
    answer.wait_for()
    stale = study(visit, "misalignment").locator(".stale")
    visit.page.wait_for_function("() => !document.querySelector('[data-study=misalignment] .stale')")
    visit.drag(visit.handles()[0], 3, 8)
    stale.wait_for()
    assert "found for another specification" in stale.inner_text()
