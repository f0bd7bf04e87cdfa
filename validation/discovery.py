"""Finds the claims and the benchmarks by walking their packages, and lists them on the command line."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Callable
from functools import cache
from types import ModuleType
from typing import Any

import click

import validation


@cache
def groups(*attributes: str) -> dict[str, list[str]]:
    """Return the packages of validation and the names of their modules that have one of some attributes."""
    found: dict[str, list[str]] = {}
    for package in pkgutil.iter_modules(validation.__path__):
        if package.ispkg:
            path = importlib.import_module(f"validation.{package.name}").__path__
            names = [each.name for each in pkgutil.iter_modules(path) if each.name != "__main__"]
            kept = [name for name in names if set(attributes) & set(vars(named(package.name, name)))]
            if kept:
                found[package.name] = kept
    return found


def module(name: str, *attributes: str) -> ModuleType:
    """Return the module of a short name, such as "fig4_linear"."""
    return next(named(group, name) for group, names in groups(*attributes).items() if name in names)


def chosen(arguments: tuple[str, ...], *attributes: str) -> list[str]:
    """Return the named modules, those of the named groups, or all if nothing is named."""
    return picked(arguments, groups(*attributes))


def picked(arguments: tuple[str, ...], known: dict[str, list[str]]) -> list[str]:
    """Return the same among known groups and their modules."""
    every = [name for names in known.values() for name in names]
    for argument in arguments:
        if argument not in known and argument not in every:
            raise click.BadParameter(f"{argument!r} is none of {', '.join([*known, *every])}")
    return [name for argument in arguments or known for name in known.get(argument, [argument])]


def first_line(documented: ModuleType) -> str:
    """Return the first line of a module's docstring."""
    return (inspect.getdoc(documented) or "").partition("\n")[0]


class Listed(click.Command):
    """A command whose help lists modules, group by group."""

    def __init__(self, *given: Any, listed: Callable[[], dict[str, list[str]]], **options: Any) -> None:
        super().__init__(*given, **options)
        self.listed = listed

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the names of each group with the first lines of their docstrings."""
        for group, names in self.listed().items():
            title = first_line(importlib.import_module(f"validation.{group}")).rstrip(".")
            with formatter.section(f"{group}, {title[0].lower()}{title[1:]}"):
                formatter.write_dl([(name, first_line(named(group, name))) for name in names])


def named(group: str, name: str) -> ModuleType:
    """Return a module of a group."""
    return importlib.import_module(f"validation.{group}.{name}")
