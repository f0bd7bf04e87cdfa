"""The files of a design, as ``metafem design`` writes them, and the panel that offers them."""

from __future__ import annotations

import asyncio
import io
import re
import zipfile
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from nicegui import ui
from nicegui.element import Element

from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.history import State
from metafem.files import result_tables, save
from metafem.report import page

SPECIFICATION, ZIPPED = "spec.toml", "specification.zip"

# Date of all entries of an archive, so that equal contents give equal archives. It is the earliest date that
# the zip format can store.
DATE = (1980, 1, 1, 0, 0, 0)

# The files that the page offers by the titles of their groups, with their meanings.
ARCHIVE = "surface.zip"
GROUPS = {
    "To make the part": {
        "mould.csv": "Mould table: position (x mirrored), depth and tool radius of each hole",
        "block.stl": "Solid of the block with its summits",
        "mould.stl": "Solid of the mould",
    },
    "To keep and to repeat the design": {
        ARCHIVE: "Everything: the result folder of metafem design",
        SPECIFICATION: "Specification, with the tables that it names",
        "report.html": "Report: one page that opens without a network",
    },
    "Data": {
        "heights.csv": "Heights: site, position, height and radius of each summit",
        "law.csv": "Law: load, area, friction and separation",
        "surface.vtu": "Surface for ParaView",
    },
}

# Files that need only the design. All other files describe the part, or are written together with it.
OF_THE_DESIGN = ("heights.csv", "law.csv")

# Messages above the files, and why a file cannot be downloaded if they do not say it.
NO_DESIGN = (
    "There is no surface for the specification as it stands, and so there are no files of one. "
    "The specification itself can be downloaded."
)
NO_PART = "The tables of the design and the specification can be downloaded."
NO_BLOCK = "needs “Block” with its width, length and thickness"

# Message if the state has no full design.
NOTHING = "there is no design; change the target or a field first"

# Message beside the link, and message after the link is copied.
LINK = "The address of this page, for this machine; colleagues need spec.toml"
COPIED = (
    "The address of this page was copied. It opens the same state on this machine while metafem explore "
    "runs. For another machine take spec.toml."
)


def specification_file(state: State) -> tuple[str, bytes]:
    """Return name and content of the specification file or, if it has tables, of a zip archive with them.

    The tables stand beside the specification, as in a result folder: a link can contain names that point
    elsewhere. A lone surrogate, which has no UTF-8 bytes, becomes a question mark.
    """
    text = state.text.encode("utf-8", "replace")
    if not state.tables:
        return SPECIFICATION, text
    tables = {re.split(r"[/\\:]", name)[-1]: table for name, table in state.tables.items()}
    files = {name: table.encode("utf-8", "replace") for name, table in tables.items() if name.strip(" .")}
    return ZIPPED, archive({**files, SPECIFICATION: text})


def command_of(state: State) -> str:
    """Return the command that creates the result folder from the downloaded specification."""
    unpack = f"unzip {ZIPPED} && " if state.tables else ""
    return f"{unpack}metafem design {SPECIFICATION} -o surface"


def made_files(answer: Answer) -> dict[str, bytes]:
    """Return the files of the result folder of an answer, by name, as ``metafem design`` writes them.

    If no part can be made, they are the tables of the design.
    """
    design, specification = answer.design, answer.specification
    if not answer.current or answer.draft or design is None or specification is None:
        raise MetafemError(NOTHING)
    if answer.no_part:
        tables = result_tables(design, specification.part)
        return {name: tables[name].encode("utf-8") for name in OF_THE_DESIGN}
    with TemporaryDirectory() as parent:
        folder = Path(parent, "surface")
        report = page(design, specification.hardness)
        save(design, folder, specification=specification, pages={"report.html": report})
        return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def archive(files: Mapping[str, bytes]) -> bytes:
    """Return the content of a zip archive with these files."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as written:
        for name, each in files.items():
            written.writestr(zipfile.ZipInfo(name, DATE), each, zipfile.ZIP_DEFLATED)
    return content.getvalue()


def hindrance(name: str, answer: Answer) -> str | None:
    """Return why a file of an answer cannot be downloaded; "" if `said_above` says it, None if it can."""
    if name == SPECIFICATION:
        return None
    if not answer.current or (answer.no_part and name not in OF_THE_DESIGN):
        return ""
    bare = answer.specification is None or answer.specification.template.block is None
    return NO_BLOCK if bare and name.endswith(".stl") else None


def said_above(answer: Answer) -> str:
    """Return the message above the files: why none or some of them can be downloaded; "" if all can."""
    if not answer.current:
        return f"{NO_DESIGN} {answer.refused}".strip()
    return f"{answer.no_part}. {NO_PART}" if answer.no_part else ""


class Taking(Panel):
    """The buttons that download the files of the newest answer, and the command that repeats the design."""

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.answer = page.answer
        self.told: State | None = None  # the state that the message is about
        self.offered: dict[str, tuple[ui.button, ui.label]] = {}
        self.above = ui.label().classes("warn").props('role="status"')
        self.above.set_visibility(False)
        self.label = ui.label().props('role="status"')
        with ui.element("div").classes("cards"):
            for title, files in GROUPS.items():
                with _card(title):
                    for name, meaning in files.items():
                        button = ui.button(name, icon="download", on_click=partial(self.take, name))
                        button.props(f'no-caps flat dense align=left data-take="{name}"')
                        self.offered[name] = button, ui.label(meaning).classes("small")
            with _card("To open it again"):
                copy = self._copy("location.href", COPIED, text="Copy link", icon="link")
                copy.props("no-caps flat dense align=left")
                ui.label(LINK).classes("small")
            with _card("The same from the command line"), ui.element("div").classes("lines"):
                self.command = ui.label(command_of(self.answer.state))
                inside = f"getHtmlElement({self.command.id}).innerText"
                copy = self._copy(inside, "The command was copied.", icon="content_copy")
                copy.props('round flat size=sm aria-label="Copy the command" title="Copy the command"')

    def _copy(self, value: str, said: str, **look: str) -> ui.button:
        """Return a button that copies the value of a JavaScript expression, and then says a text."""
        # in the browser, which allows copying only in the handler of a click
        copied = f"() => navigator.clipboard.writeText({value})"
        return ui.button(on_click=partial(self.say, said), **look).on("click", js_handler=copied)

    def show(self, answer: Answer, _: object) -> None:
        """Enable the files that an answer has, and say why others cannot be taken."""
        if answer.draft and not answer.stopped:
            return  # changed labels would slow a drag down
        self.answer = answer
        self.command.text = command_of(answer.state)
        if self.told is not None and not self.told.designs_the_same(answer.state):
            self.told, self.label.text = None, ""
        for files in GROUPS.values():
            for name, meaning in files.items():
                button, label = self.offered[name]
                reason = hindrance(name, answer)
                label.text = f"{meaning}: {reason}" if reason else meaning
                button.set_enabled(reason is None)
        self.above.text = said_above(answer)
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
        if name == SPECIFICATION:
            return await asyncio.to_thread(specification_file, answer.state)
        self.say("The files are being written.")
        found = await asyncio.to_thread(made_files, answer)
        return name, found[name] if name != ARCHIVE else await asyncio.to_thread(archive, found)

    def say(self, text: str) -> None:
        """Show a message about the current design."""
        self.told, self.label.text = self.answer.state, text


def _card(title: str) -> Element:
    """Return the element of a group of files, with its title."""
    card = ui.element("section").classes("card take")
    with card, ui.element("h3"):
        ui.label(title)
    return card
