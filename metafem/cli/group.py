"""The group of all commands, their common options and their exit codes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

import metafem as mf
from metafem._given import Names
from metafem.cli.output import printing, show_error
from metafem.cli.signals import report_stop, stopped_by_signals
from metafem.errors import InvalidInput, MetafemError, named
from metafem.files.specification.models import MODELS

# The contact laws in words, as `form` in files/specification/options.py states them.
CONTACTS = (
    *("hertz", "sphere", "power EXPONENT [COEFFICIENT]", "profile FILE"),
    *("jkr ADHESION_ENERGY [CAP]", "kogut-etsion HARDNESS", "jackson-green YIELD_STRENGTH"),
    "tabulated FILE",
)

# Options that errors propose for arguments.
ARGUMENTS = Names({"force=True": "--force", "workers=2": "--workers 2"})

# Key of the units of the quantities in the context of a command.
UNITS = "metafem.units"

# Exit codes: unreachable target, and invalid input.
NOT_ACHIEVED, BAD_INPUT = 1, 2


class Ended(click.ClickException):
    """An error of the package with the name of its type, for the terminal."""

    def __init__(self, kind: str, message: str, **data: Any) -> None:
        super().__init__(message)
        self.kind, self.data = kind, data


class Name(click.Path):
    """The name of a file or folder, as a Path; an empty one would mean the current folder."""

    name = "path"

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path."""
        if value == "":
            self.fail("the name is empty; write the name of a file or folder", param, ctx)
        return super().convert(value, param, ctx)


class Quantity(click.ParamType):  # type: ignore[type-arg]
    """A quantity with its unit, as a number in the package's unit; a list of them if `listed`.

    The unit of the first one is stored in the context, for errors.
    """

    name = "quantity"

    def __init__(
        self,
        unit: str = "",
        example: str | None = None,
        *,
        listed: bool = False,
        read: Callable[[str], Any] | None = None,
    ) -> None:
        self.read = read or (lambda text: mf.files.converted(text, unit, example))
        self.listed = listed

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Return the number of a text, or the numbers of a list separated by commas."""
        if not isinstance(value, str):
            return value
        parts = value.split(",") if self.listed else [value]
        ctx.meta.setdefault(UNITS, {}).setdefault(param.name, mf.files.written_unit(parts[0]))
        try:
            found = [self.read(part) for part in parts]
        except InvalidInput as error:
            raise error.at(param.opts[0]) from None
        return found if self.listed else found[0]


def option_names() -> Names:
    """Return the names of the running command's options, and the units in which they were written."""
    ctx = click.get_current_context()
    names = {each.name: each.opts[0] for each in ctx.command.params if each.name and each.opts[0][:1] == "-"}
    return Names(names, {name: unit for name, unit in ctx.meta.get(UNITS, {}).items() if unit})


class Commands(click.Group):
    """A group whose commands end with a message and an exit code instead of a traceback."""

    def main(self, args: Any = None, *rest: Any, **extra: Any) -> Any:
        """Parse the arguments and run the command; with --json errors are JSON too."""
        given = sys.argv[1:] if args is None else args
        extra["standalone_mode"] = False  # the exit code is set here
        with stopped_by_signals(), report_stop("no unfinished file is left"), printing():
            try:
                code = super().main(args, *rest, **extra)
            except click.ClickException as error:
                show_error(error, "--json" in given)
                code = BAD_INPUT if getattr(error, "kind", "") == "InvalidInput" else error.exit_code
            sys.exit(code if isinstance(code, int) else 0)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        try:
            with named(ARGUMENTS):
                return super().invoke(ctx)
        except InvalidInput as error:
            raise Ended("InvalidInput", str(error)) from None
        except MetafemError as error:
            raise Ended(type(error).__name__, str(error)) from None
        except OSError as error:
            if error.filename is None:  # an error of the output stream has no file name
                raise
            words = f"{error.filename!s:.300}: {error.strerror}"
            raise Ended("InvalidInput", words) from None


def model_option(default: str, multiple: bool = False) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return the decorator that adds --model and --contact; `default` is their default in words."""
    again = " May be repeated, to compare laws." if multiple else ""
    text = f"Model of the law, from single contacts to resolved ones.{again} Default: {default}."
    model = click.option("--model", type=click.Choice(tuple(MODELS)), multiple=multiple, help=text)
    law = default.replace("independent", "hertz")
    text = f"Law of one contact, a kind and its values: {', '.join(CONTACTS)}."
    text += f' For example --contact "jkr 9 mJ/m^2 sphere".{again} Default: {law}.'
    contact = click.option(
        "--contact", metavar="LAW", multiple=multiple, help=text, shell_complete=_contact_kinds
    )
    return lambda command: model(contact(command))


def _contact_kinds(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Return the kinds of contact laws for shell completion."""
    kinds = (law.partition(" ")[0] for law in CONTACTS)
    return [kind for kind in kinds if kind.startswith(incomplete)]


json_option = click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print only data, as JSON; an error is an object with type and message.",
)
force_option = click.option("--force", is_flag=True, help="Replace the unchanged files that metafem wrote.")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="metafem")
def main() -> None:
    """Design surfaces with a friction law of your choice.

    Output is in mm, N and MPa; values in specifications and options are written with their unit.
    """
