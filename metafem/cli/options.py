"""Types of options, options that several commands share, and the decorator of a command."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import click

import metafem as mf
from metafem.errors import InvalidInput, refuse_if
from metafem.files.specification import MODELS

Decorator = Callable[[Any], Any]

# Type of an option that names a file or folder.
Name = partial(click.Path, path_type=Path)

# Key in the context of a command: the texts of its options, by name.
TEXTS = "metafem.texts"


class Command(click.Command):
    """A command whose errors name its options, with the texts that were given, instead of arguments."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments, and keep the texts of the options."""
        ctx.meta[TEXTS] = self.make_parser(ctx).parse_args([*args])[0]
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except InvalidInput as error:
            raise self._in_options(error, ctx.meta[TEXTS]) from None

    def _in_options(self, error: InvalidInput, texts: Mapping[str, Any]) -> InvalidInput:
        """Return an error of an argument as one of the option of this name."""
        path, bracket, rest = error.key.partition("[")
        label = {each.name: max(each.opts, key=len) for each in self.params}.get(path.rpartition(".")[2])
        text = texts.get(path.rpartition(".")[2])
        if label is None or (text is None and error.value is not None):
            return error
        found = error.at(f"{label}{bracket}{rest}")
        if isinstance(found.value, float) and text is not None:
            found.value = text if isinstance(text, str) else ", ".join(text)
        return found


class Quantity(click.ParamType):  # type: ignore[type-arg]
    """Type of an option that is a quantity with a unit, or a list of quantities if `listed` is true."""

    name = "quantity"

    def __init__(self, unit: str, example: str | None = None, *, listed: bool = False) -> None:
        self.unit, self.example, self.listed = unit, example, listed

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Return the number that a text states, or the numbers in a list with commas; 0 has any unit."""
        if not isinstance(value, str):
            return value
        parts = [part.strip() for part in value.split(",")] if self.listed else [value.strip()]
        try:
            found = [
                0.0 if each == "0" else mf.files.converted(each, self.unit, self.example) for each in parts
            ]
        except InvalidInput as error:
            raise error.at(max(param.opts, key=len)) from None
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
    return click.option(option_name(name), type=kind, help=words, **settings)


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
    law = 'Law of one contact: a kind of [contact] and its value, such as "jkr 9 mJ/m^2". Default: '
    return [
        click.option("--model", type=click.Choice(tuple(MODELS)), help=model),
        click.option("--contact", metavar="LAW", help=f"{law}{default.replace('independent', 'hertz')}."),
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
