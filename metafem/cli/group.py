"""The group of all commands, their common options and their exit codes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

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

# Exit codes: unreachable target, and invalid input.
NOT_ACHIEVED, BAD_INPUT = 1, 2


class Ended(click.ClickException):
    """An error of the package with the name of its type, for the terminal."""

    def __init__(self, kind: str, message: str, **data: Any) -> None:
        super().__init__(message)
        self.kind, self.data = kind, data


class BadInput(Ended):
    """Input that cannot be used."""

    exit_code = BAD_INPUT


class NotAchieved(Ended):
    """A target that cannot be reached."""

    exit_code = NOT_ACHIEVED


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
                code = error.exit_code
            sys.exit(code if isinstance(code, int) else 0)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        try:
            with named(ARGUMENTS):
                return super().invoke(ctx)
        except InvalidInput as error:
            raise BadInput("InvalidInput", str(error)) from None
        except MetafemError as error:
            raise NotAchieved(type(error).__name__, str(error)) from None
        except OSError as error:
            if error.filename is None:  # an error of the output stream has no file name
                raise
            raise BadInput("InvalidInput", f"{error.filename!s:.300}: {error.strerror}") from None


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
