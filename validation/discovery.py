"""Finds the claims and the benchmarks by walking their packages, and lists them on the command line."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from functools import cache
from types import ModuleType

import click

import validation


@cache
def groups(attribute: str) -> dict[str, list[str]]:
    """Return the packages of validation and the names of their modules that have an attribute."""
    found: dict[str, list[str]] = {}
    for package in pkgutil.iter_modules(validation.__path__):
        if package.ispkg:
            path = importlib.import_module(f"validation.{package.name}").__path__
            names = [module.name for module in pkgutil.iter_modules(path) if module.name != "__main__"]
            kept = [name for name in names if hasattr(_module(package.name, name), attribute)]
            if kept:
                found[package.name] = kept
    return found


def module(attribute: str, name: str) -> ModuleType:
    """Return the module of a short name, such as "fig4_linear"."""
    return next(_module(group, name) for group, names in groups(attribute).items() if name in names)


def chosen(attribute: str, arguments: tuple[str, ...]) -> list[str]:
    """Return the named modules, those of the named groups, or all if nothing is named."""
    known = groups(attribute)
    every = [name for names in known.values() for name in names]
    for argument in arguments:
        if argument not in known and argument not in every:
            raise click.BadParameter(f"{argument!r} is none of {', '.join([*known, *every])}")
    return [name for argument in arguments or known for name in known.get(argument, [argument])]


def first_line(module: ModuleType) -> str:
    """Return the first line of a module's docstring."""
    return (inspect.getdoc(module) or "").partition("\n")[0]


class Listed(click.Command):
    """A command whose help lists the modules that have one of its attributes, group by group."""

    attributes: tuple[str, ...] = ()

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the names of each group with the first lines of their docstrings."""
        for attribute in self.attributes:
            for group, names in groups(attribute).items():
                title = first_line(importlib.import_module(f"validation.{group}")).rstrip(".")
                with formatter.section(f"{group}, {title[0].lower()}{title[1:]}"):
                    formatter.write_dl([(name, first_line(_module(group, name))) for name in names])


def _module(group: str, name: str) -> ModuleType:
    return importlib.import_module(f"validation.{group}.{name}")
