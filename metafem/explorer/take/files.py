"""Files of a design, as ``metafem design`` writes them, and why some of them cannot be downloaded."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from metafem.drawing import svg
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.session import State
from metafem.files import result_tables, staged, write_all
from metafem.inversion import Design
from metafem.report import page
from metafem.report.figures import law_figure

SPECIFICATION, ZIPPED = "spec.toml", "specification.zip"

# Date of all entries of an archive, so that equal contents give equal archives. It is the earliest date that
# the zip format can store.
DATE = (1980, 1, 1, 0, 0, 0)

# Python script that computes the design from the downloaded specification.
SCRIPT = 'import metafem as mf\n\nspec = mf.read_spec("spec.toml")\nprint(spec.design())\n'

# Files that need only the design. All other files describe the part, or are written together with it.
OF_THE_DESIGN = ("heights.csv", "law.csv", "law.svg")

# Messages above the files.
NO_DESIGN = (
    "There is no surface for the specification as it stands, and so there are no files of one. "
    "The specification itself can be downloaded."
)
NO_PART = "The tables of the design and the specification can be downloaded."

# Reasons why a file cannot be downloaded. The message above the files states those in `ABOVE` in full; the
# others are shown beside the file.
NEEDS_DESIGN, NEEDS_PART = "needs a surface", "needs a part that can be made"
ABOVE = ("", NEEDS_DESIGN, NEEDS_PART)
NO_BLOCK = "needs “Block” with its width, length and thickness"


def specification_file(state: State) -> tuple[str, bytes]:
    """Return name and content of the specification file or, if it has tables, of a zip archive with them.

    A link can contain table names that point outside the folder of the archive, where the tables would be
    unpacked. In this case, all tables are renamed as in a result folder, without folders. A lone surrogate,
    which has no UTF-8 bytes, becomes a question mark.
    """
    text = state.text.encode("utf-8", "replace")
    if not state.tables:
        return SPECIFICATION, text
    files = {name: table.encode("utf-8", "replace") for name, table in state.tables.items()}
    if not all(map(_lies_within, state.tables)):
        try:
            return ZIPPED, archive(specification_of(state).files)
        except InvalidInput:  # the text cannot be read, so the tables that it needs are unknown
            files = {}
    return ZIPPED, archive({**files, SPECIFICATION: text})


def command_of(state: State) -> str:
    """Return the command that creates the result folder from the downloaded specification."""
    unpack = f"unzip {ZIPPED} && " if state.tables else ""
    return f"{unpack}metafem design {SPECIFICATION} -o surface"


def _lies_within(name: str) -> bool:
    """Return whether a file is unpacked inside the folder of its archive and is not the specification."""
    return name != SPECIFICATION and not re.search(r"^[/.]|\\|:|(^|/)\.\.?(/|$)|/$|^$", name)


def tables_of(answer: Answer) -> dict[str, bytes]:
    """Return the tables of an answer's design, by file name; empty if its state has no full design."""
    if not answer.current or answer.draft or answer.design is None or answer.specification is None:
        return {}
    tables = result_tables(answer.design, answer.specification.part)
    return {name: text.encode("utf-8") for name, text in tables.items()}


def law_picture(design: Design) -> bytes:
    """Return the content of an SVG file with the figure of the law, as in a report."""
    return (svg(law_figure(design), design.target.title) + "\n").encode("utf-8")


def made_files(answer: Answer) -> dict[str, bytes]:
    """Return all files of the result folder of an answer, by name, as ``metafem design`` writes them."""
    design, specification = answer.design, answer.specification
    assert design is not None
    assert specification is not None
    with TemporaryDirectory() as parent:
        folder = Path(parent, "surface")
        with staged(folder, folder=True) as fresh:
            report = page(design, specification.hardness)
            write_all(design, fresh, specification, {"report.html": report})
        return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def archive(files: Mapping[str, bytes]) -> bytes:
    """Return the content of a zip archive with these files."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as written:
        for name, each in files.items():
            written.writestr(zipfile.ZipInfo(name, DATE), each, zipfile.ZIP_DEFLATED)
    return content.getvalue()


def hindrance(name: str, answer: Answer, problem: str = "") -> str:
    """Return why a file of an answer cannot be downloaded; "" if it can.

    `problem` states why no part can be made; it is "" if a part can be made.
    """
    if not answer.current:
        return NEEDS_DESIGN
    if problem and name not in OF_THE_DESIGN:
        return NEEDS_PART
    specification = answer.specification
    if specification is None or not name.endswith(".stl") or specification.template.block is not None:
        return ""
    return NO_BLOCK


def said_above(answer: Answer, problem: str = "") -> str:
    """Return the message above the files: why none or some of them can be downloaded; "" if all can."""
    if not answer.current:
        return f"{NO_DESIGN} {answer.refused}".strip()
    return f"{problem[:1].upper()}{problem[1:]}. {NO_PART}" if problem else ""
