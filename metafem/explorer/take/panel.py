"""The panel with the files of the design."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from nicegui import background_tasks, ui
from nicegui.element import Element

from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.certainty.places import part_problem
from metafem.explorer.session import State
from metafem.explorer.take.command import command_of, script_of
from metafem.explorer.take.files import archive, law_picture, made_files, specification_file, tables_of
from metafem.explorer.take.hindrance import NEEDS_DESIGN, NEEDS_PART, hindrance, said_above

if TYPE_CHECKING:
    from metafem.explorer.page import Page


class File(NamedTuple):
    """A file of the result folder: its name and its meaning."""

    name: str
    meaning: str


# Tables of the current design, which are written at once, and files that take some seconds.
TABLES = (
    File("mould.csv", "Mould table: position, depth and tool radius of each hole"),
    File("heights.csv", "Heights: site, position, height and radius of each summit"),
    File("law.csv", "Law: load, area, friction and separation"),
)
MADE = (
    File("report.html", "Report: one page that opens without a network"),
    File("block.stl", "Solid of the block with its summits"),
    File("mould.stl", "Solid of the mould"),
    File("mould.svg", "Drawing of the mould with its holes"),
    File("surface.vtu", "Surface for ParaView"),
)

PICTURE = File("law.svg", "Picture of the law, with its difference from the target")

SPECIFICATION_FILE = File("spec.toml", "Specification, with the tables that it names")

# Message beside the link, and message after the link is copied.
LINK = "The address of this page, for this machine; colleagues need spec.toml"
COPIED = (
    "It opens the same state on this machine while metafem explore runs. For another machine take spec.toml."
)

# Message if the state has no full design.
NOTHING = "There is no design to take: the target or a field must be changed first."

# Name of the background computation, and of the archive.
TASK, ARCHIVE = "files", "surface.zip"


class Making:
    """The files of a state, which a background process writes once. They are stored for further downloads."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.wanted = ""
        self.state: State | None = None
        self.files: dict[str, bytes] = {}
        self.told: State | None = None
        with ui.row().classes("row"):
            self.label = ui.label().props('role="status"')
            self.stop = ui.button("Stop", on_click=self.stopped).props("flat dense no-caps")
        self.stop.set_visibility(False)

    async def take(self, name: str) -> None:
        """Download a file of the current design or the archive of all files; if needed, write them first."""
        state = self.page.answer.state
        if not self.page.answer.current or self.page.answer.draft:
            self.say(NOTHING)
        elif self.state is not None and self.state.designs_the_same(state):
            await self.download(name)
        else:
            self.wanted, self.state, self.files = name, None, {}
            self.stop.set_visibility(True)
            self.say("The files are being written.")
            self.page.tasks.start(
                TASK, made_files, (state,), self.stepped, partial(self.made, state), self.failed
            )

    def stepped(self, step: str, done: float | None) -> None:
        """Show the current step of the process."""
        self.say(f"The files are being written: {step}.")

    def made(self, state: State, files: dict[str, bytes]) -> None:
        """Store the files, and download the requested file."""
        self.state, self.files = state, files
        self.stop.set_visibility(False)
        background_tasks.create(self.download(self.wanted))

    def failed(self, error: MetafemError) -> None:
        """Show why the files cannot be written."""
        self.stop.set_visibility(False)
        self.say(f"The files were not written: {error}")

    def stopped(self) -> None:
        """Stop the process."""
        self.page.tasks.stop(TASK)
        self.stop.set_visibility(False)
        self.say("The files were not written: they were stopped.")

    async def download(self, name: str) -> None:
        """Send a file to the browser."""
        content = self.files.get(name)
        if name == ARCHIVE:
            content = await self.page.in_thread(archive, self.files)
        if content is None:
            self.say(
                f"{name} is not a file of this specification, which has {', '.join(self.files)}. Solids need "
                "“Block” in the workshop, and their formats are those of “Part files”."
            )
            return
        with self.label:
            ui.download.content(content, name)
        self.say(f"{name} was downloaded ({len(content) / 1e3:,.0f} kB).")

    def say(self, text: str) -> None:
        """Show a message about the current design."""
        self.told = self.page.answer.state
        if self.label.text != text:
            self.label.text = text

    def follow(self, answer: Answer) -> None:
        """Remove the message if it is about another design, except while files are being written."""
        if self.told is not None and not self.stop.visible and not self.told.designs_the_same(answer.state):
            self.told, self.label.text = None, ""


def take_panel(page: Page) -> None:
    """Create the buttons that download the design, and the command that produces the same result."""
    ui.add_css(Path(__file__).with_name("take.css"))
    above = ui.label().classes("warn").props('role="status"')
    above.set_visibility(False)
    making, offered = Making(page), list[Offered]()
    problem = ""

    def add(file: File) -> None:
        take = partial(_table, page, making) if file in TABLES else making.take
        offered.append(_button(file, partial(take, file.name)))

    with ui.element("div").classes("cards"):
        with _card("To make the part"):
            for file in (TABLES[0], *MADE[1:4]):
                add(file)
        with _card("To keep and to repeat the design"):
            add(File(ARCHIVE, "Everything: the result folder of metafem design"))
            _button(SPECIFICATION_FILE, partial(_specification, page, making))
            copy = ui.button("Copy link", icon="link", on_click=partial(_copied, making))
            copy.props("no-caps flat dense align=left")
            # runs in the browser, which allows copying only in the handler of a click
            copy.on("click", js_handler="() => navigator.clipboard.writeText(location.href)")
            ui.label(LINK).classes("small")
            add(MADE[0])
        with _card("Data"):
            for file in TABLES[1:]:
                add(file)
            offered.append(_button(PICTURE, partial(_picture, page, making)))
            add(MADE[4])
        with _card("The same by a command"):
            command = _lines(making, "command", command_of(page.state))
            _lines(making, "script", script_of())

    def offer() -> None:
        """Enable the available files, and show why the other files are not available."""
        for each in offered:
            each.offer(hindrance(each.file.name, page.answer, problem))
        words = said_above(page.answer, problem)
        if above.text != words:
            above.text = words
            above.set_visibility(bool(words))

    def show(answer: Answer) -> None:
        making.follow(answer)
        if command.text != command_of(answer.state):
            command.text = command_of(answer.state)
        offer()

    def warn(places: Mapping[str, list[str]]) -> None:
        nonlocal problem
        problem = " ".join(places.get("take", []))
        offer()

    page.listen(show)
    page.listen_warnings(warn)


class Offered(NamedTuple):
    """A button that downloads a file, and its label."""

    file: File
    button: ui.button
    label: ui.label

    def offer(self, hindrance: str) -> None:
        """Enable the button, or disable it and show why the file cannot be downloaded."""
        own = hindrance not in ("", NEEDS_DESIGN, NEEDS_PART)  # these reasons appear above the files
        words = f"{self.file.meaning}: {hindrance}" if own else self.file.meaning
        if self.label.text != words:
            self.label.text = words
        if self.button.enabled == bool(hindrance):
            self.button.set_enabled(not hindrance)


def _card(title: str) -> Element:
    """Return the element of a group of files, with its title."""
    card = ui.element("section").classes("card take")
    with card, ui.element("h3"):
        ui.label(title)
    return card


def _button(file: File, take: Callable[[], Awaitable[None]]) -> Offered:
    """Return a button that downloads a file, with the meaning of the file as its label."""
    button = ui.button(file.name, icon="download", on_click=take)
    button.props(f'no-caps flat dense align=left data-take="{file.name}"')
    return Offered(file, button, ui.label(file.meaning).classes("small"))


def _lines(making: Making, name: str, text: str) -> ui.label:
    """Return a label that shows the text unchanged, next to a button that copies the text."""
    with ui.element("div").classes("lines"):
        lines = ui.label(text)
        copy = ui.button(icon="content_copy", on_click=lambda: making.say(f"The {name} was copied."))
        copy.props(f'round flat size=sm aria-label="Copy the {name}" title="Copy the {name}"')
        copy.on(
            "click", js_handler=f"() => navigator.clipboard.writeText(getHtmlElement({lines.id}).innerText)"
        )
    return lines


def _copied(making: Making) -> None:
    making.say(f"The address of this page was copied. {COPIED}")


async def _table(page: Page, making: Making, name: str) -> None:
    """Download a table of the current design; the mould table only if the part can be made."""
    answer = page.answer
    tables = await page.in_thread(tables_of, answer)
    problem = await page.in_thread(part_problem, answer) if name == "mould.csv" else ""
    if problem:
        making.say(f"{name} was not downloaded: {problem}")
    elif name in tables:
        ui.download.content(tables[name], name)
        making.say(f"{name} was downloaded.")
    else:
        making.say(NOTHING)


async def _picture(page: Page, making: Making) -> None:
    """Download the figure of the law."""
    answer = page.answer
    if not answer.current or answer.draft or answer.design is None:
        making.say(NOTHING)
        return
    content = await page.in_thread(law_picture, answer.design)
    ui.download.content(content, PICTURE.name)
    making.say(f"{PICTURE.name} was downloaded.")


async def _specification(page: Page, making: Making) -> None:
    """Download the specification, even if it has problems."""
    name, content = await page.in_thread(specification_file, page.answer.state)
    ui.download.content(content, name)
    making.say(f"{name} was downloaded.")
