"""The group of all commands; a module is imported when one of its commands runs."""

from __future__ import annotations

import json
import sys
from importlib import import_module
from typing import Any

import click

from metafem.errors import InvalidInput, MetafemError

# Module of each command.
MODULES = {
    "demo": "design", "design": "design", "spec": "design", "predict": "predict", "study": "study",
    "calibrate": "calibrate", "images": "images", "compare": "compare",
    "report": "design", "explore": "design", "doctor": "doctor",
}  # fmt: skip

# Key in the context of a command: the texts of its quantities, by the name of the option.
TEXTS = "metafem.texts"

# Exit codes for a target that is not achieved, for invalid input, and after Ctrl-C.
NOT_ACHIEVED, BAD_INPUT, STOPPED = 1, 2, 130


class Command(click.Command):
    """A command whose errors name its options instead of arguments."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except InvalidInput as error:
            raise in_options(error, ctx) from None


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
        as_json = "--json" in (sys.argv[1:] if args is None else args)
        try:
            code = super().main(args, *rest, **{**extra, "standalone_mode": False})
        except click.ClickException as error:
            code = _told(error, "Usage", error.exit_code, as_json)
        except MetafemError as error:
            code = BAD_INPUT if isinstance(error, InvalidInput) else NOT_ACHIEVED
            _told(click.ClickException(str(error)), type(error).__name__, code, as_json)
        except OSError as error:
            text = f"{error.filename or 'the output'!s:.300}: {error.strerror}"
            code = BAD_INPUT if error.filename else NOT_ACHIEVED
            _told(click.ClickException(text), "InvalidInput", code, as_json)
        except click.Abort:
            click.echo("stopped; no unfinished file is left", err=True)
            code = STOPPED
        sys.exit(code if isinstance(code, int) else 0)


def _told(error: click.ClickException, kind: str, code: int, as_json: bool) -> int:
    """Print an error and return the exit code."""
    if as_json:
        click.echo(json.dumps({"error": {"type": kind, "message": error.format_message()}}))
    else:
        error.show()
    return code


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="metafem")
def main() -> None:
    """Design surfaces with a friction law of your choice.

    Output is in mm, N and MPa. Values in specifications and options are written with their units.
    """
