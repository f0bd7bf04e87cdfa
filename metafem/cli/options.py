"""Types of options, options that several commands share, and the decorator of a command."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import click

import metafem as mf
from metafem.cli.group import TEXTS, Command
from metafem.errors import InvalidInput, refuse_if
from metafem.files.specification import MODELS

Decorator = Callable[[Any], Any]

# How the option --contact states each contact law.
CONTACTS = """hertz, elastic, jkr ADHESION_ENERGY [CAP], kogut-etsion HARDNESS, jackson-green YIELD_STRENGTH,
tabulated FILE"""

# Type of an option that names a file or folder.
Name = partial(click.Path, path_type=Path)

# Placeholder of a quantity in `--help`, by its unit.
PLACEHOLDERS = {"mm": "LENGTH", "N": "FORCE", "rad": "ANGLE", "MPa": "STRESS", "%": "PERCENT", "1": "NUMBER"}


class Quantity(click.ParamType):  # type: ignore[type-arg]
    """Type of an option that is a quantity with a unit, or a list of quantities if `listed` is true.

    The value is a number in the package's unit; the unit "load" is that of a rescaled load or a force. The
    texts are stored in the context, for errors.
    """

    name = "quantity"

    def __init__(self, unit: str, example: str | None = None, *, listed: bool = False) -> None:
        self.unit, self.example, self.listed = unit, example, listed

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Return the number that a text states, or the numbers in a list with commas; 0 has any unit."""
        if not isinstance(value, str):
            return value
        label = max(param.opts, key=len)
        parts = [part.strip() for part in value.split(",")] if self.listed else [value.strip()]
        ctx.meta.setdefault(TEXTS, {}).setdefault(param.name, (label, []))[1].extend(parts)
        try:
            if self.unit == "load":
                return mf.files.given_load(value)
            found = [
                0.0 if part == "0" else mf.files.converted(part, self.unit, self.example) for part in parts
            ]
        except InvalidInput as error:
            raise error.at(label) from None
        return found if self.listed else found[0]


def command(*options: Decorator, **settings: Any) -> Decorator:
    """Return the decorator of a command with options in the order in which `--help` lists them."""

    def add(function: Any) -> Any:
        for option in reversed(options):
            function = option(function)
        return click.command(cls=Command, **settings)(function)

    return add


def quantity(name: str, unit: str, example: str, text: str, **settings: Any) -> Decorator:
    """Return the option of a quantity; the example is inserted at `{}` in the help text."""
    kind = float if unit == "1" else Quantity(unit, example)
    words = text.format(f'"{example}"')
    return click.option(option_name(name), type=kind, metavar=PLACEHOLDERS[unit], help=words, **settings)


def quantities(declared: Mapping[str, tuple[str, str, str]]) -> list[Decorator]:
    """Return options of quantities from their names, units, examples and help texts."""
    return [quantity(name, *each) for name, each in declared.items()]


def file_option(names: str, metavar: str, text: str, **settings: Any) -> Decorator:
    """Return the option of a file or folder, whose names are separated by blanks."""
    return click.option(*names.split(), type=Name(), metavar=metavar, help=text, **settings)


def option_name(name: str) -> str:
    """Return the name of the option for an argument, such as "--height-sd" for "height_sd"."""
    return f"--{name.replace('_', '-')}"


def model_options(default: str) -> list[Decorator]:
    """Return the options --model and --contact; `default` describes their default."""
    model = f"Model of the law; automatic is the fastest that is accurate enough. Default: {default}."
    law = f'Law of one contact, a kind and its values: {CONTACTS}; such as "jkr 9 mJ/m^2 elastic". Default: '
    law += f"{default.replace('independent', 'hertz')}."
    return [
        click.option("--model", type=click.Choice(tuple(MODELS)), help=model),
        click.option("--contact", metavar="LAW", help=law),
    ]


json_option = click.option("--json", "as_json", is_flag=True, help="Print data alone, also errors, as JSON.")
force_option = click.option("--force", is_flag=True, help="Replace existing files.")
column_option = click.option(
    "--column",
    multiple=True,
    metavar="NAME=TITLE",
    help='Column with another title, load="Kraft [N]", or load_N=Kraft without a unit; may be repeated.',
)


def columns_of(given: tuple[str, ...]) -> dict[str, str]:
    """Return the titles of columns by the names that they stand for, from the option --column."""
    columns = {}
    for text in given:
        name, _, title = map(str.strip, text.partition("="))
        words = f'--column "{text:.60}" must be NAME=TITLE, such as load="Kraft [N]"'
        refuse_if(not (name and title), words)
        columns[name] = title
    return columns


def refuse_files(force: bool, *files: Path | None) -> None:
    """Raise InvalidInput before a long run if one of the files that it writes would be refused."""
    for path in filter(None, files):
        mf.files.refuse_existing(path, force)
