"""The panel with the files of the design."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from functools import partial

from nicegui import ui
from nicegui.element import Element

from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.session import State
from metafem.explorer.take import files
from metafem.inversion import Design

# Names of the archive and of the picture.
ARCHIVE, PICTURE = "surface.zip", "law.svg"

# The files that the page offers and their meanings. Tables, pictures and the specification are written at
# once; all other files take some seconds.
MEANINGS = {
    "mould.csv": "Mould table: position (x mirrored), depth and tool radius of each hole",
    "heights.csv": "Heights: site, position, height and radius of each summit",
    "law.csv": "Law: load, area, friction and separation",
    "report.html": "Report: one page that opens without a network",
    "block.stl": "Solid of the block with its summits",
    "mould.stl": "Solid of the mould",
    "surface.vtu": "Surface for ParaView",
    PICTURE: "Picture of the law, with its difference from the target",
    files.SPECIFICATION: "Specification, with the tables that it names",
    ARCHIVE: "Everything: the result folder of metafem design",
}
QUICK = ("mould.csv", "heights.csv", "law.csv", PICTURE)

# Message beside the link, and message after the link is copied.
LINK = "The address of this page, for this machine; colleagues need spec.toml"
COPIED = (
    "The address of this page was copied. It opens the same state on this machine while metafem explore "
    "runs. For another machine take spec.toml."
)

# Message if the state has no full design.
NOTHING = "there is no design; change the target or a field first"


class Taking(Panel):
    """The buttons that download the files of the newest answer, and the command that repeats the design."""

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.answer, self.problem = page.answer, ""
        self.made: tuple[State, asyncio.Task[dict[str, bytes]]] | None = None  # all files of a state
        self.told: State | None = None  # the state that the message is about
        self.offered: dict[str, tuple[ui.button, ui.label]] = {}
        self.above = ui.label().classes("warn").props('role="status"')
        self.above.set_visibility(False)
        self.label = ui.label().props('role="status"')
        with ui.element("div").classes("cards"):
            self._cards()

    def _cards(self) -> None:
        """Create the cards with their buttons."""
        with _card("To make the part"):
            self._buttons("mould.csv", "block.stl", "mould.stl")
        with _card("To keep and to repeat the design"):
            self._buttons(ARCHIVE, files.SPECIFICATION)
            copy = self._copy("location.href", COPIED, text="Copy link", icon="link")
            copy.props("no-caps flat dense align=left")
            ui.label(LINK).classes("small")
            self._buttons("report.html")
        with _card("Data"):
            self._buttons("heights.csv", "law.csv", PICTURE, "surface.vtu")
        with _card("The same from the command line"):
            self.command = self._lines("command", files.command_of(self.answer.state))
            self._lines("script", files.SCRIPT)

    def _buttons(self, *names: str) -> None:
        """Create buttons that download files, each with the meaning of the file beside it."""
        for name in names:
            button = ui.button(name, icon="download", on_click=partial(self.take, name))
            button.props(f'no-caps flat dense align=left data-take="{name}"')
            self.offered[name] = button, ui.label(MEANINGS[name]).classes("small")

    def _lines(self, name: str, text: str) -> ui.label:
        """Return a label that shows the text unchanged, next to a button that copies the text."""
        with ui.element("div").classes("lines"):
            lines = ui.label(text)
            inside = f"getHtmlElement({lines.id}).innerText"
            copy = self._copy(inside, f"The {name} was copied.", icon="content_copy")
            copy.props(f'round flat size=sm aria-label="Copy the {name}" title="Copy the {name}"')
        return lines

    def _copy(self, value: str, said: str, **look: str) -> ui.button:
        """Return a button that copies the value of a JavaScript expression, and then says a text."""
        # in the browser, which allows copying only in the handler of a click
        copied = f"() => navigator.clipboard.writeText({value})"
        return ui.button(on_click=partial(self.say, said), **look).on("click", js_handler=copied)

    def show(self, answer: Answer, _: object) -> None:
        """Offer the files of an answer; a message about another design goes."""
        self.answer = answer
        self.command.text = files.command_of(answer.state)
        if self.told is not None and not self.told.designs_the_same(answer.state):
            self.told, self.label.text = None, ""
        self._offer()

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show why no part can be made from the answer."""
        self.problem = " ".join(places.get("take", []))
        self._offer()

    def _offer(self) -> None:
        """Enable the available files, and show why the other files are not available."""
        for name, (button, label) in self.offered.items():
            reason = "" if name == files.SPECIFICATION else files.hindrance(name, self.answer, self.problem)
            label.text = MEANINGS[name] if reason in files.ABOVE else f"{MEANINGS[name]}: {reason}"
            button.set_enabled(not reason)
        self.above.text = files.said_above(self.answer, self.problem)
        self.above.set_visibility(bool(self.above.text))

    async def take(self, name: str) -> None:
        """Download a file of the newest answer, or show why this is impossible."""
        try:
            name, content = await self._content(name, self.answer)
        except MetafemError as error:
            self.say(f"{name} was not downloaded: {error}")
        else:
            ui.download.content(content, name)
            self.say(f"{name} was downloaded.")

    async def _content(self, name: str, answer: Answer) -> tuple[str, bytes]:
        """Return the name and the content of a file of an answer."""
        if name == files.SPECIFICATION:
            return await asyncio.to_thread(files.specification_file, answer.state)
        if not answer.current or answer.draft or answer.design is None:
            raise MetafemError(NOTHING)
        if name in QUICK:
            return name, await asyncio.to_thread(self._quick, name, answer, answer.design)
        found = await self._made(answer)
        return name, found[name] if name != ARCHIVE else await asyncio.to_thread(files.archive, found)

    def _quick(self, name: str, answer: Answer, design: Design) -> bytes:
        """Return the content of one of the files in `QUICK`."""
        if name == PICTURE:
            return files.law_picture(design)
        if name == "mould.csv" and answer.no_part:
            raise MetafemError(answer.no_part)
        return files.tables_of(answer)[name]

    async def _made(self, answer: Answer) -> dict[str, bytes]:
        """Return all files of an answer; those of one state are written once."""
        if self.made is None or not self.made[0].designs_the_same(answer.state):
            self.say("The files are being written.")
            self.made = answer.state, asyncio.create_task(asyncio.to_thread(files.made_files, answer))
        try:
            return await self.made[1]
        except Exception:
            self.made = None
            raise

    def say(self, text: str) -> None:
        """Show a message about the current design."""
        self.told, self.label.text = self.answer.state, text


def _card(title: str) -> Element:
    """Return the element of a group of files, with its title."""
    card = ui.element("section").classes("card take")
    with card, ui.element("h3"):
        ui.label(title)
    return card
