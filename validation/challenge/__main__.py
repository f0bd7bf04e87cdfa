"""Design a surface for every target with metafem, score it, and write `best/*.json`."""

from __future__ import annotations

import click

from validation.challenge.best_results import renewed
from validation.challenge.score import line
from validation.challenge.task import BadInput, names, target


@click.command()
@click.argument("chosen", nargs=-1, metavar="[NAME ...]")
def main(chosen: tuple[str, ...]) -> None:
    """Design a surface for the targets NAME, or for all, and write `validation/challenge/best/NAME.json`."""
    for name in chosen or names():
        try:
            click.echo(line(renewed(target(name))[1]))
        except BadInput as error:
            raise click.UsageError(str(error)) from None


if __name__ == "__main__":
    main()
