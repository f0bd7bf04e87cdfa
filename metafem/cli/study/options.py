"""Options that several studies share, and the arguments that they state."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli.group import Quantity, model_option

if TYPE_CHECKING:
    from metafem.inversion import Design

Options = Callable[[Callable[..., Any]], Callable[..., Any]]

# Errors of a made surface besides those of its heights, with the unit, example and meaning of each.
ERRORS: Mapping[str, tuple[str, str, str]] = {
    "angle": ("rad", "0.05deg", "Largest tilt about either axis"),
    "radius_sd": ("mm", "2um", "Standard deviation of the radii"),
    "position_sd": ("mm", "5um", "Standard deviation of x and of y of each site"),
}


def with_options(*options: Options) -> Options:
    """Return a decorator that adds several options to a command; `--help` lists them in this order."""

    def add(command: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            command = option(command)
        return command

    return add


def error_option(name: str) -> Options:
    """Return the option that states an error of the made surface."""
    unit, example, meaning = ERRORS[name]
    return click.option(
        option_name(name),
        type=Quantity(unit, example),
        default=0.0,
        metavar="QUANTITY",
        help=f"{meaning}, such as {example}. Default: 0.",
    )


def option_name(name: str) -> str:
    """Return the name of the option for an argument, such as "--height-sd" for "height_sd"."""
    return f"--{name.replace('_', '-')}"


seed_option = click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the random numbers."
)

law_options = with_options(
    model_option("that of the folder"),
    click.option(
        "--load-range",
        type=Quantity(read=lambda text: mf.files.given_load(text)),
        nargs=2,
        metavar="FROM TO",
        help="Loads between which the slope is fitted, P/E* or P, such as 0.05mm^2 0.2mm^2. Default: 25 to "
        "100 % of the load at which the plane reaches the lowest asperity.",
    ),
)


draws_option = click.option(
    "--draws", type=click.IntRange(min=2), default=10_000, show_default=True, help="Number of draws."
)

workers_option = click.option(
    "--workers",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Number of processes; the numbers do not depend on it.",
)


def study_arguments(design: Design, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a study that the options of the law, the draws and the seed state."""
    model = mf.files.chosen_model(design.law.model, options["model"], options["contact"])
    mf.files.refuse_missing_block(model, design.surface, "design the folder again with a section [block]")
    given = options["load_range"]
    loads = None if given is None else mf.files.rescaled_range(given, design.surface.material)
    found = {"model": model, "load_range": loads, "rng": options["seed"]}
    return found | ({"draws": options["draws"]} if "draws" in options else {})
