"""`python -m metafem` is the metafem command."""

from metafem.cli import run

run()
