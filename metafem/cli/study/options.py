"""Options that several studies share, and their values as the Python functions take them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    pass

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

# Each error of a made surface: unit, example, help.
ERRORS: Mapping[str, tuple[str, str, str]] = {
    "height_sd": ("mm", "3um", "Standard deviation of the heights"),
    "angle": ("rad", "0.05deg", "Largest tilt about either axis"),
    "radius_sd": ("mm", "2um", "Standard deviation of the radii"),
    "position_sd": ("mm", "5um", "Standard deviation of x and of y of each site"),
}

seed_option = click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the random numbers."
)

load_range_option = click.option(
    "--load-range",
    nargs=2,
    metavar="FROM TO",
    help="Loads over which the slope is fitted, P/E* in mm^2 or P in N, such as 0.05mm^2 0.2mm^2. "
    "Default: 25 to 100 % of the load at which the plane reaches the lowest asperity.",
)


def together(*options: Decorator) -> Decorator:
    """Return one decorator that adds several options in this order."""

    def add(command: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            command = option(command)
        return command

    return add
