"""The chapters of the report, from `chapters.toml`."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Chapter:
    """A page of the report: file name, title, the question that it answers, and its claims in order."""

    name: str
    title: str
    question: str
    claims: list[str]


CHAPTERS = tuple(
    Chapter(**each)
    for each in tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))["chapter"]
)
