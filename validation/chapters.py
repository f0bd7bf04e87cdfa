"""The chapters of the report, from `chapters.toml`, and the modules of their claims."""

from __future__ import annotations

import inspect
import tomllib
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Chapter:
    """A page of the report: file name, title, the question that it answers, and its claims in order."""

    name: str
    title: str
    question: str
    claims: tuple[str, ...]


LISTED = tomllib.loads((FOLDER / "chapters.toml").read_text("utf-8"))["chapter"]
CHAPTERS = tuple(Chapter(**each | {"claims": tuple(each["claims"])}) for each in LISTED)


def module_of(name: str) -> ModuleType:
    """Return the module of a claim, of a unique name in one of the folders."""
    (file,) = FOLDER.glob(f"*/{name}.py")
    return import_module(f"validation.{file.parent.name}.{name}")


def first_line(name: str) -> str:
    """Return the first line of the docstring of a claim's module."""
    return (inspect.getdoc(module_of(name)) or "").partition("\n")[0]


def chosen(arguments: tuple[str, ...]) -> list[str]:
    """Return the named claims, those of the named chapters, or all if nothing is named.

    An unknown name raises KeyError.
    """
    chapters = {chapter.name: chapter.claims for chapter in CHAPTERS}
    known = chapters | {name: (name,) for names in chapters.values() for name in names}
    return [name for argument in arguments or chapters for name in known[argument]]
