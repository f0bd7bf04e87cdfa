"""The group of all commands, with their common options and exit codes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

import metafem as mf
from metafem._given import Names
from metafem.cli.output import printing, show_error
from metafem.errors import InvalidInput, MetafemError, named
from metafem.files.specification.models import MODELS

# How the option --contact states each contact law; `form` in files/specification/options.py returns the same
# texts.
CONTACTS = (
    *(
        "hertz",
        "elastic",
        "jkr ADHESION_ENERGY [CAP]",
        "kogut-etsion HARDNESS",
        "jackson-green YIELD_STRENGTH",
    ),
    "tabulated FILE",
)

# Names in errors: the option of the command instead of the argument of a Python function.
ARGUMENTS = Names({"force=True": "--force"})

# Key in the context of a command; its value holds the units in which quantities were written.
UNITS = "metafem.units"

# Exit codes for a target that is not achieved, for invalid input, and after Ctrl-C.
NOT_ACHIEVED, BAD_INPUT, STOPPED = 1, 2, 130


class Ended(click.ClickException):
    """An error of the package as click prints it; `kind` is the name of its type, `data` is for JSON."""

    def __init__(self, kind: str, message: str, **data: Any) -> None:
        super().__init__(message)
        self.kind, self.data = kind, data


class Name(click.Path):
    """Type of an option that names a file or folder; an empty name is refused.

    Path would read an empty name as the current folder.
    """

    name = "path"

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path that a text names."""
        if value == "":
            self.fail("the name is empty; write the name of a file or folder", param, ctx)
        return super().convert(value, param, ctx)


class Quantity(click.ParamType):  # type: ignore[type-arg]
    """Type of an option that is a quantity with a unit, or a list of quantities if `listed` is true.

    The value is a number in the package's unit. The unit of the first quantity is stored in the context, so
    that errors state values in this unit.
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
        """Return the number that a text states, or the numbers in a list separated by commas."""
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
    """Return how errors name the options of the running command, and the units in which they were written."""
    ctx = click.get_current_context()
    names = {each.name: each.opts[0] for each in ctx.command.params if each.name and each.opts[0][:1] == "-"}
    return Names(names, {name: unit for name, unit in ctx.meta.get(UNITS, {}).items() if unit})


class Commands(click.Group):
    """A group of commands; an error ends a command with a message and an exit code, without a traceback."""

    def main(self, args: Any = None, *rest: Any, **extra: Any) -> Any:
        """Parse the arguments, run the command and exit; with --json, an error is printed as JSON too."""
        given = sys.argv[1:] if args is None else args
        extra["standalone_mode"] = False  # the exit code is set here
        with printing():
            try:
                code = super().main(args, *rest, **extra)
            except click.ClickException as error:
                show_error(error, "--json" in given)
                code = BAD_INPUT if getattr(error, "kind", "") == "InvalidInput" else error.exit_code
            except click.Abort:
                click.echo("stopped; no unfinished file is left", err=True)
                code = STOPPED
            sys.exit(code if isinstance(code, int) else 0)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command, and raise errors of the package as `Ended`."""
        try:
            with named(ARGUMENTS):
                return super().invoke(ctx)
        except InvalidInput as error:
            raise Ended("InvalidInput", str(error)) from None
        except MetafemError as error:
            raise Ended(type(error).__name__, str(error)) from None
        except OSError as error:
            if error.filename is None:  # an error of the output stream, not of a file
                raise
            words = f"{error.filename!s:.300}: {error.strerror}"
            raise Ended("InvalidInput", words) from None


def model_option(default: str, multiple: bool = False) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return the decorator that adds the options --model and --contact; `default` describes their default."""
    again = " May be repeated, to compare laws." if multiple else ""
    text = f"Model of the law, from single contacts to resolved ones.{again} Default: {default}."
    model = click.option("--model", type=click.Choice(tuple(MODELS)), multiple=multiple, help=text)
    law = default.replace("independent", "hertz")
    text = f"Law of one contact, a kind and its values: {', '.join(CONTACTS)}."
    text += f' For example --contact "jkr 9 mJ/m^2 elastic".{again} Default: {law}.'
    contact = click.option(
        "--contact", metavar="LAW", multiple=multiple, help=text, shell_complete=_contact_kinds
    )
    return lambda command: model(contact(command))


def _contact_kinds(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Return the kinds of contact laws that begin with `incomplete`, for shell completion."""
    kinds = (law.partition(" ")[0] for law in CONTACTS)
    return [kind for kind in kinds if kind.startswith(incomplete)]


json_option = click.option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print only data, as JSON; an error is an object with type and message.",
)
force_option = click.option("--force", is_flag=True, help="Replace existing files.")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="metafem")
def main() -> None:
    """Design surfaces with a friction law of your choice.

    Output is in mm, N and MPa. Values in specifications and options are written with their units.
    """
