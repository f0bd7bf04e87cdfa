"""The command metafem: its entry point, the group of all commands, and how a command ends."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
from importlib import import_module
from typing import Any

import click

from metafem.errors import InvalidInput, MetafemError

__all__ = ["main", "run"]

# Module of each command, which is imported when the command runs.
MODULES = {
    "demo": "design", "design": "design", "spec": "design", "predict": "predict", "study": "study",
    "calibrate": "calibrate", "images": "images", "compare": "compare",
    "report": "design", "explore": "design", "doctor": "doctor",
}  # fmt: skip

# Exit codes for a target that is not achieved, for invalid input, and after Ctrl-C.
NOT_ACHIEVED, BAD_INPUT, STOPPED = 1, 2, 130

# Time after Ctrl-C in which a command can remove what it has begun to write [s].
LEAVE = 0.5


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
        except (click.ClickException, MetafemError, OSError) as error:
            code = _told(error, as_json)
        except click.Abort:
            click.echo("stopped; no unfinished file is left", err=True)
            code = STOPPED
        sys.exit(code if isinstance(code, int) else 0)


def _told(error: Exception, as_json: bool) -> int:
    """Print an error and return the exit code."""
    if isinstance(error, OSError):
        error = InvalidInput(f"{error.filename or 'the output'!s:.300}: {error.strerror}")
    kind, code = type(error).__name__, BAD_INPUT if isinstance(error, InvalidInput) else NOT_ACHIEVED
    shown = click.ClickException(str(error))
    if isinstance(error, click.ClickException):
        shown, kind, code = error, "Usage", error.exit_code
    if as_json:
        click.echo(json.dumps({"error": {"type": kind, "message": shown.format_message()}}))
    else:
        shown.show()
    return code


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="metafem")
def main() -> None:
    """Design surfaces with a friction law of your choice.

    Output is in mm, N and MPa. Values in specifications and options are written with their units.
    """


def run() -> None:
    """Run the metafem command; Ctrl-C and SIGTERM end it with the exit codes 130 and 143.

    BLAS uses one thread by default, because the dense systems of a design are small. More threads only wait
    for each other, which takes up to ten times as long on a busy machine, and the last digit of a result can
    depend on their number. OPENBLAS_NUM_THREADS sets another number.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy's import reads this variable
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.reconfigure(errors="replace")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # files that are being written are removed
    ended = _ending_soon()
    try:
        main(prog_name="metafem")
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    finally:
        ended.set()


def _ending_soon() -> threading.Event:
    """End the process soon after Ctrl-C, also within a factorisation, until the returned event is set.

    Python raises KeyboardInterrupt only when such a call of a library returns, which may take seconds.
    """
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing)
    ended = threading.Event()

    def watch() -> None:
        while os.read(reading, 1)[0] != signal.SIGINT:
            pass
        if not ended.wait(LEAVE):
            os.write(2, b"stopped\n")
            os._exit(STOPPED)

    if sys.argv[1:2] != ["explore"]:  # whose server ends by itself
        threading.Thread(target=watch, daemon=True).start()
    return ended
