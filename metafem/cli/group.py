"""The group of all commands, what they share and how they end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from metafem.cli.signals import stopped_by_signals
from metafem.errors import InvalidInput, MetafemError

DEMOS = ("operating-points", "linear", "bilinear")

# The kinds that `metafem.files` knows, listed here so that --help needs no import.
MODELS = ("independent", "mean-field", "half-space", "layer", "block", "resolved", "automatic")

# Exit codes: a target that cannot be reached, and input that cannot be used.
NOT_ACHIEVED, BAD_INPUT = 1, 2


class BadInput(click.ClickException):
    """Input that cannot be used, on its way to the terminal."""

    exit_code = BAD_INPUT


class NotAchieved(click.ClickException):
    """A target that cannot be reached, on its way to the terminal."""

    exit_code = NOT_ACHIEVED


class Commands(click.Group):
    """A group whose commands end in a message and an exit code instead of a traceback."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Parse the arguments and run the command."""
        with stopped_by_signals():
            return super().main(*args, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except InvalidInput as error:
            # errors name the argument of Python's functions
            raise BadInput(str(error).replace("force=True", "--force")) from None
        except MetafemError as error:
            raise NotAchieved(str(error)) from None


def model_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --model to a command."""
    choice = click.Choice(MODELS)
    return click.option("--model", type=choice, help="Model of the predicted law; the file's unless told.")(
        command
    )


json_option = click.option("--json", "as_json", is_flag=True, help="Print data alone, as JSON.")
force_option = click.option("--force", is_flag=True, help="Overwrite what is there.")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="metafem")
def main() -> None:
    """Design surfaces with a friction law of your choice.

    Lengths are in mm, forces in N, moduli in MPa; files say their units.
    """
