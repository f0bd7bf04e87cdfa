"""The panel that shows how reliable the design is."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Coroutine, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import background_tasks, ui
from nicegui.element import Element

from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.certainty import band
from metafem.explorer.certainty.long_studies import STUDIES, Found, run
from metafem.explorer.certainty.panel_data import at_once, figure_data, found_data, list_data, study_data
from metafem.explorer.certainty.places import part_warnings, warnings_by_place

if TYPE_CHECKING:
    from metafem.explorer.page import Page

STYLE = Path(__file__).with_name("certainty.css")

TAB = "How sure"

# Program errors are written to the terminal with their traceback.
LOG = logging.getLogger(__name__)

# Time without a new answer after which the figures are computed, and after which random surfaces within the
# tolerances are drawn [s].
PAUSE, REST = 0.3, 1.0


class SureFigures(Element, component="sure_figures.js"):
    """The table of the figures; emits ``ready`` when it can receive data."""


class SureStudies(Element, component="sure_studies.js"):
    """The long studies; emits ``ready``, ``start`` and ``stop`` with the name of a study."""

    def __init__(self) -> None:
        super().__init__()
        self._props["studies"] = list_data()


class PlaceWarnings(Element, component="place_warnings.js"):
    """The warnings for one part of the page."""


class Rest:
    """Starts a task `seconds` after the last call of `begin`; `failed` is called with its errors."""

    def __init__(
        self,
        seconds: float,
        task: Callable[[], Coroutine[Any, Any, None]],
        failed: Callable[[Exception], None],
    ) -> None:
        self.seconds, self.task, self.failed = seconds, task, failed
        self.timer: asyncio.TimerHandle | None = None

    def begin(self) -> None:
        """Restart the waiting time."""
        self.end()
        self.timer = asyncio.get_running_loop().call_later(self.seconds, self.start)

    def start(self) -> None:
        """Start the task at once."""
        background_tasks.create(self._run())

    async def _run(self) -> None:
        try:
            await self.task()
        except Exception as error:
            LOG.exception("what is computed at rest was not shown")
            self.failed(error)

    def end(self) -> None:
        """Cancel the waiting time."""
        if self.timer is not None:
            self.timer.cancel()


class Certainty:
    """The figures and studies of one page; they are updated some time after the last answer."""

    def __init__(self, page: Page) -> None:
        self.page, self.visible, self.ready = page, False, False
        self.client = ui.context.client
        self.pause, self.rest = (
            Rest(PAUSE, self._figures, page.wrong),
            Rest(REST, self._draw, page.wrong),
        )
        with ui.element("div").classes("certainty"):
            self.table, self.studies = SureFigures(), SureStudies()
        self.studies.on("ready", self._opened)
        self.studies.on("start", lambda event: self._start(event.args))
        self.studies.on("stop", lambda event: self._stop(event.args))
        page.listen(self._answered)
        page.tabs.on_value_change(lambda event: self._turned(event.value))
        self.client.on_delete(self._left)

    def _answered(self, answer: Answer) -> None:
        self.pause.begin()
        self.rest.begin()

    def _turned(self, tab: str) -> None:
        self.visible = tab == TAB
        if self.visible:
            self.pause.begin()

    def _opened(self) -> None:
        """Show the figures; the browser creates these elements only when the tab is first opened."""
        self.ready = self.visible = True
        self.pause.start()

    def _left(self) -> None:
        self.pause.end()
        self.rest.end()

    async def _figures(self) -> None:
        """Compute and show the warnings of the answer and, if the tab is open, its figures.

        While the tab is closed, a large surface gets only the warnings about its part.
        """
        answer, seen = self.page.answer, self.visible and self.ready
        if self.client.is_deleted:
            return
        known = warnings_by_place if seen or at_once(answer) else part_warnings
        places = await self.page.in_thread(known, answer)
        data = await self.page.in_thread(figure_data, answer) if seen else None
        studies = await self.page.in_thread(study_data, answer) if seen else None
        if answer is not self.page.answer:
            return
        self.page.warn(places)
        if data is not None:
            self.table.run_method("show", data)
            self.studies.run_method("follow", studies)

    async def _draw(self) -> None:
        """Draw random surfaces within the tolerances for the band of the law, until the design changes."""
        answer = self.page.answer

        def wanted() -> bool:
            return answer.design is self.page.answer.design and not self.client.is_deleted

        if band.drawn_of(answer) is not None:
            return
        await self.page.in_thread(band.draw, answer, wanted)
        if band.drawn_of(answer) is not None and wanted():
            self.page.again()

    async def _start(self, name: Any) -> None:
        answer = self.page.answer
        if name not in STUDIES:
            return
        found = await self.page.in_thread(study_data, answer)
        reason, shown = found["hindered"][name], found["shown"]
        if reason or answer.design is None:
            self._tell(name, {"error": reason})
            return

        def on_step(step: str, done: float | None) -> None:
            self._tell(name, {"step": step, "done": done})

        def on_done(found: Found) -> None:
            self._tell(name, {"running": False, "found": found_data(found, shown)})

        def on_error(error: MetafemError) -> None:
            self._tell(name, {"running": False, "error": str(error)})

        self._tell(name, {"running": True, "step": "starting a process", "done": None, "error": ""})
        given = name, answer.design, band.tolerances_of(answer)
        self.page.tasks.start(name, run, given, on_step, on_done, on_error)

    def _stop(self, name: Any) -> None:
        if name in STUDIES:
            self.page.tasks.stop(name)
            self._tell(name, {"running": False})

    def _tell(self, name: str, change: dict[str, Any]) -> None:
        """Send changed data of a study to the browser."""
        if not self.client.is_deleted:
            self.studies.run_method("change", name, change)


def certainty_panel(page: Page) -> None:
    """Create the table of the figures and the list of long studies."""
    ui.add_css(STYLE.read_text("utf-8"))
    Certainty(page)


def place_warnings(page: Page, place: str) -> None:
    """Create the warning line of a part of the page, "law" or "surface"."""
    line = PlaceWarnings()
    shown: list[str] = []

    def show(warnings: Mapping[str, list[str]]) -> None:
        nonlocal shown
        if warnings.get(place, []) != shown:
            shown = warnings.get(place, [])
            line.run_method("show", shown)

    page.listen_warnings(show)
