"""The group of all commands; a module is imported when one of its commands runs."""

from __future__ import annotations

import json
import os
import sys
from importlib import import_module
from typing import Any

import click

from metafem.errors import InvalidInput, MetafemError

# Module of each command.
MODULES = {
    "demo": "design", "design": "design", "spec": "design", "predict": "predict", "study": "study",
    "calibrate": "calibrate", "images": "images", "topography": "topography", "compare": "compare",
    "report": "design", "explore": "design", "doctor": "doctor",
}  # fmt: skip

# Key in the context of a command: the texts of its quantities, by the name of the option.
TEXTS = "metafem.texts"

# Exit codes for a target that is not achieved, for invalid input, and after Ctrl-C.
NOT_ACHIEVED, BAD_INPUT, STOPPED = 1, 2, 130


class Ended(click.ClickException):
    """An error of the package as click prints it; `kind` is the name of its type, `data` is for JSON."""

    def __init__(self, kind: str, message: str, **data: Any) -> None:
        super().__init__(message)
        self.kind, self.data = kind, data


class Command(click.Command):
    """A command whose errors are `Ended`, and name its options instead of arguments."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except InvalidInput as error:
            raise Ended("InvalidInput", str(in_options(error, ctx))) from None
        except MetafemError as error:
            raise Ended(type(error).__name__, str(error)) from None
        except OSError as error:
            if error.filename is None:  # an error of the output stream, not of a file
                raise
            raise Ended("InvalidInput", f"{error.filename!s:.300}: {error.strerror}") from None


def in_options(error: InvalidInput, ctx: click.Context) -> InvalidInput:
    """Return an error of an argument as one of the option of this name that was given."""
    name, bracket, rest = error.key.partition("[")
    option = f"--{name.replace('_', '-')}"
    label, texts = ctx.meta.get(TEXTS, {}).get(name, (option, ()))
    given = texts or ctx.params.get(name) not in (None, (), False)
    if not given and (error.value is not None or name not in ctx.params):
        return error
    found = error.at(f"{label}{bracket}{rest}")
    if error.value is not None and texts:
        index = int(rest[:-1]) if rest[:-1].isdecimal() else 0
        found.value = texts[min(index, len(texts) - 1)]
    return found


class Commands(click.Group):
    """The group of all commands; an error ends a command with a message and an exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands, in the order in which they are used."""
        return list(MODULES)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Return a command, after the import of its module."""
        if name not in MODULES:
            return None
        found: click.Command = getattr(import_module(f"metafem.cli.{MODULES[name]}"), name)
        return found

    def main(self, args: Any = None, *rest: Any, **extra: Any) -> Any:
        """Parse the arguments, run the command and exit; with --json, an error is printed as JSON too."""
        given = sys.argv[1:] if args is None else args
        extra["standalone_mode"] = False  # the exit code is set here
        try:
            code = super().main(args, *rest, **extra)
        except click.ClickException as error:
            code = BAD_INPUT if getattr(error, "kind", "") == "InvalidInput" else error.exit_code
            if "--json" in given:
                about = {"type": getattr(error, "kind", "Usage"), "message": error.format_message()}
                click.echo(json.dumps({"error": about | getattr(error, "data", {})}))
            else:
                error.show()
        except OSError as error:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or Python reports the error again when it exits
            click.echo(f"Error: the output cannot be written: {error.strerror}", err=True)
            code = NOT_ACHIEVED
        except click.Abort:
            click.echo("stopped; no unfinished file is left", err=True)
            code = STOPPED
        sys.exit(code if isinstance(code, int) else 0)


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="metafem")
def main() -> None:
    """Design surfaces with a friction law of your choice.

    Output is in mm, N and MPa. Values in specifications and options are written with their units.
    """
