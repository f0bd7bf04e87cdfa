"""Reasons why files of a design cannot be downloaded."""

from __future__ import annotations

from metafem.explorer.answer import Answer

# Files that need only the design. All other files describe the part, or are written together with it.
OF_THE_DESIGN = ("heights.csv", "law.csv", "law.svg", "figure.zip")

# Messages above the files.
NO_DESIGN = (
    "There is no surface for the specification as it stands, and so there are no files of one. "
    "The specification itself can be downloaded."
)
NO_PART = "The tables of the design and the specification can be downloaded."
# Short reasons shown beside a file. For the first two, a message above the files gives the full reason.
NEEDS_DESIGN, NEEDS_PART = "needs a surface", "needs a part that can be made"
NO_BLOCK = "needs “Block” with its width, length and thickness"


def hindrance(name: str, answer: Answer, problem: str = "") -> str:
    """Return why a file of an answer cannot be downloaded; "" if it can.

    `problem` states why no part can be made; it is "" if a part can be made.
    """
    if not answer.current:
        return NEEDS_DESIGN
    if problem and name not in OF_THE_DESIGN:
        return NEEDS_PART
    stem, _, kind = name.partition(".")
    specification = answer.specification
    if specification is None or stem not in ("block", "mould") or kind == "csv":
        return ""
    if specification.template.block is None:
        return NO_BLOCK
    if kind != "svg" and kind not in specification.part.formats:
        return f"needs “{kind}” among the “formats” of “Part files”"
    return ""


def said_above(answer: Answer, problem: str = "") -> str:
    """Return the message above the files: why none or some of them can be downloaded; "" if all can."""
    if not answer.current:
        return f"{NO_DESIGN} {answer.refused}".strip()
    return f"{problem[:1].upper()}{problem[1:]}. {NO_PART}" if problem else ""
