"""Writes the computed parts of validation/guide/proof.md, each between its own pair of marks."""

from __future__ import annotations

from pathlib import Path

PAGE = Path(__file__).with_name("guide") / "proof.md"


def renew(part: str, body: str) -> None:
    """Replace a part, whose marks have its name."""
    begin, end = f"<!-- {part}: python -m validation --readme -->", f"<!-- end of the {part} -->"
    text = PAGE.read_text("utf-8")
    head, tail = text.split(begin)[0], text.split(end)[1]
    PAGE.write_text(f"{head}{begin}\n{body}\n{end}{tail}", "utf-8")
