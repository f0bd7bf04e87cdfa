"""Writes the computed parts of README.md, each between its own pair of marks."""

from __future__ import annotations

from pathlib import Path

README = Path(__file__).parents[1] / "README.md"


def renew(marks: tuple[str, str], body: str) -> None:
    """Replace the part between two marks."""
    text = README.read_text("utf-8")
    head, tail = text.split(marks[0])[0], text.split(marks[1])[1]
    README.write_text(f"{head}{marks[0]}\n{body}\n{marks[1]}{tail}", "utf-8")
