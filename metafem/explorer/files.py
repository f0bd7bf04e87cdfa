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

from metafem.drawing import svg
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.history import State
from metafem.files import result_tables, save
from metafem.report import page
from metafem.report.figures import law_figure

SPECIFICATION, ZIPPED = "spec.toml", "specification.zip"

# Date of all entries of an archive, so that equal contents give equal archives. It is the earliest date that
# the zip format can store.
DATE = (1980, 1, 1, 0, 0, 0)

# Python script that computes the design from the downloaded specification.
SCRIPT = 'import metafem as mf\n\nspec = mf.read_spec("spec.toml")\nprint(spec.design())\n'

# The files that the page offers by the titles of their groups, with their meanings.
ARCHIVE, PICTURE = "surface.zip", "law.svg"
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
        PICTURE: "Picture of the law, with its difference from the target",
        "surface.vtu": "Surface for ParaView",
    },
}

# Files that need only the design. All other files describe the part, or are written together with it.
OF_THE_DESIGN = ("heights.csv", "law.csv", PICTURE)

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


def quick_files(answer: Answer) -> dict[str, bytes]:
    """Return the tables and the picture of an answer's design, by file name, which take no time."""
    design, specification = answer.design, answer.specification
    if not answer.current or answer.draft or design is None or specification is None:
        raise MetafemError(NOTHING)
    found = result_tables(design, specification.part)
    if answer.no_part:
        del found["mould.csv"]
    found[PICTURE] = svg(law_figure(design), design.target.title) + "\n"
    return {name: text.encode("utf-8") for name, text in found.items()}


def made_files(answer: Answer) -> dict[str, bytes]:
    """Return all files of the result folder of an answer, by name, as ``metafem design`` writes them."""
    design, specification = answer.design, answer.specification
    assert design is not None
    assert specification is not None
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


def hindrance(name: str, answer: Answer, problem: str = "") -> str | None:
    """Return why a file of an answer cannot be downloaded; "" if `said_above` says it, None if it can.

    `problem` states why no part can be made; it is "" if a part can be made.
    """
    if name == SPECIFICATION:
        return None
    if not answer.current or (problem and name not in OF_THE_DESIGN):
        return ""
    bare = answer.specification is None or answer.specification.template.block is None
    return NO_BLOCK if bare and name.endswith(".stl") else None


def said_above(answer: Answer, problem: str = "") -> str:
    """Return the message above the files: why none or some of them can be downloaded; "" if all can."""
    if not answer.current:
        return f"{NO_DESIGN} {answer.refused}".strip()
    return f"{problem[:1].upper()}{problem[1:]}. {NO_PART}" if problem else ""


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
            with _card("The same from the command line"):
                self.command = self._lines("command", command_of(self.answer.state))
                self._lines("script", SCRIPT)

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
        self.command.text = command_of(answer.state)
        if self.told is not None and not self.told.designs_the_same(answer.state):
            self.told, self.label.text = None, ""
        self._offer()

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show why no part can be made from the answer."""
        self.problem = " ".join(places.get("take", []))
        self._offer()

    def _offer(self) -> None:
        """Enable the available files, and show why the other files are not available."""
        for files in GROUPS.values():
            for name, meaning in files.items():
                button, label = self.offered[name]
                reason = hindrance(name, self.answer, self.problem)
                label.text = f"{meaning}: {reason}" if reason else meaning
                button.set_enabled(reason is None)
        self.above.text = said_above(self.answer, self.problem)
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
        found = await asyncio.to_thread(quick_files, answer)
        if name not in found:
            found = await self._made(answer)
        return name, found[name] if name != ARCHIVE else await asyncio.to_thread(archive, found)

    async def _made(self, answer: Answer) -> dict[str, bytes]:
        """Return all files of an answer; those of one state are written once."""
        if self.made is None or not self.made[0].designs_the_same(answer.state):
            self.say("The files are being written.")
            self.made = answer.state, asyncio.create_task(asyncio.to_thread(made_files, answer))
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
