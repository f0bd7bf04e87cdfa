"""Output of the command on terminals that lack characters, and errors of the output stream."""

from __future__ import annotations

import codecs
import errno
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import click

# Replacements of characters that a terminal cannot show; all other such characters become a question mark.
PLAIN = {
    "λ": "lambda",
    "σ": "sigma",
    "ν": "nu",
    "µ": "u",
    "μ": "mu",
    "δ": "delta",
    "π": "pi",
    "²": "^2",
    "³": "^3",
    "°": " deg",
    "·": "*",
    "×": "x",
    "±": "+-",
    "≤": "<=",
    "≥": ">=",
    "–": "-",
    "—": "-",
    "−": "-",
    "…": "...",
    "→": "->",
    "’": "'",
    "“": '"',
    "”": '"',
    "√": "sqrt",
}


def plainly(error: UnicodeError) -> tuple[str, int]:
    """Return the replacement of characters that an encoding lacks, and the position after them.

    This function is an error handler of `codecs`.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(PLAIN.get(c, "?") for c in error.object[error.start : error.end]), error.end


@contextmanager
def printing() -> Iterator[None]:
    """Replace characters that the terminal lacks; exit with a message if the output cannot be written."""
    codecs.register_error("metafem.plainly", plainly)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="metafem.plainly")
    try:
        try:
            yield
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except OSError as error:
        _abandon_output()
        if error.errno == errno.EPIPE:  # the program that reads the output has closed the pipe
            sys.exit(1)
        with suppress(OSError):
            click.echo(f"Error: the output cannot be written: {error.strerror}", err=True)
        sys.exit(1)


def _abandon_output() -> None:
    """Discard the buffered output, because Python would otherwise report an error when it exits."""
    with suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def show_error(error: click.ClickException, as_json: bool) -> None:
    """Print an error as text on stderr, or as JSON on stdout instead of the data."""
    if as_json:
        kind = getattr(error, "kind", "Usage")
        data = getattr(error, "data", {})
        click.echo(json.dumps({"error": {"type": kind, "message": error.format_message(), **data}}))
    else:
        error.show()
