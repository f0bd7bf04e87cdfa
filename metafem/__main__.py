"""`python -m metafem` is the metafem command."""

from metafem.cli import main

main(prog_name="metafem")
