"""`metafem study manufacturing` and `metafem study misalignment`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click
import numpy as np

import metafem as mf
from metafem.cli.group import Quantity
from metafem.cli.study.group import of_design, study
from metafem.cli.study.options import (
    ERRORS,
    draws_option,
    error_option,
    law_options,
    seed_option,
    study_arguments,
    workers_option,
)

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem._validate import FloatArray
    from metafem.inversion import Design

# Default standard deviations of the heights, as in Fig. S3: 0 to 3 um in steps of 0.1 um [mm].
LEVELS = [i * 1e-4 for i in range(31)]

# Default largest angle, as in Fig. S2.
ANGLE = "0.1deg"


@study.command(short_help="How accurate the heights must be.")
@click.option(
    "--height-sd",
    type=Quantity("mm", "3um", listed=True),
    multiple=True,
    metavar="LENGTHS",
    help="Standard deviations of the heights, such as 0.9um,3um; may be repeated. Default: 0 to 3 um in "
    "steps of 0.1 um.",
)
@error_option("angle")
@error_option("radius_sd")
@error_option("position_sd")
@click.option("--misfit", is_flag=True, help="Compare each law also with the target; this takes longer.")
@law_options
@draws_option
@seed_option
@workers_option
@of_design
def manufacturing(design: Design, **options: Any) -> Dataset:
    """Study the law of surfaces whose heights have random errors.

    Each height has an independent Gaussian error. A line is fitted to each law over a range of loads. The
    mean and the scatter (standard deviation) of its slope over the random surfaces are printed, and with
    --misfit the misfit from the target that 95 % of the surfaces do not exceed. Other errors may be added.
    The result is the file DIR/manufacturing.nc.

    Example: metafem study manufacturing linear --height-sd 0.9um,3um
    """
    return mf.studies.manufacturing(
        design if options["misfit"] else design.surface,
        [*itertools.chain(*options["height_sd"])] or LEVELS,
        others=mf.Tolerances(**{name: options[name] for name in ERRORS}),
        **study_arguments(design, options),
    )


def _steps(angles: Sequence[float]) -> list[FloatArray]:
    """Return the angles [rad] of equal steps from 0 to the first angle, and from each angle to the next.

    A step is at most the largest angle divided by `STEPS`, as for a single angle.
    """
    from metafem.studies.misalignment import STEPS

    step = angles[-1] / STEPS * (1.0 + 1e-9)  # tolerates the rounding error of a quotient
    ends = itertools.pairwise([0.0, *angles])
    return [np.linspace(low, high, math.ceil((high - low) / step) + 1)[1:] for low, high in ends]


@study.command(short_help="How level the plane must be.")
@click.option(
    "--angle",
    type=Quantity("rad", "0.05deg", listed=True),
    multiple=True,
    default=(ANGLE,),
    metavar="ANGLES",
    help="Largest angle, which is reached in 1,000 steps, or several that are reached in steps of this size, "
    f"such as 0.005deg,0.1deg; may be repeated. Default: {ANGLE}.",
)
@click.option(
    "--axes",
    type=click.Choice(("both", "x", "y")),
    default="both",
    show_default=True,
    help="Whether the surface is inclined along x and y together, or along one of them.",
)
@click.option(
    "--shuffles",
    type=click.IntRange(min=0),
    default=20,
    show_default=True,
    help="Number of random assignments of the heights to sites to compare with.",
)
@law_options
@seed_option
@workers_option
@of_design
def misalignment(design: Design, **options: Any) -> Dataset:
    """Study the law of a surface that is tilted relative to the plane.

    The scatter (standard deviation) of the slope is taken over all angles from minus to plus the largest
    angle. It depends on the assignment of the heights to sites, so that random assignments are also studied.
    The result is the file DIR/misalignment.nc.

    Example: metafem study misalignment linear --angle 0.05deg --shuffles 100
    """
    angles = [*itertools.chain(*options["angle"])]
    increasing = all(low < high for low, high in itertools.pairwise([0.0, *angles]))
    parts = _steps(angles) if increasing else [np.array(angles)]  # the study refuses such angles
    found = mf.studies.misalignment(
        design.surface,
        np.concatenate(parts) if len(angles) > 1 else angles[0],
        axes=options["axes"],
        shuffles=options["shuffles"],
        **study_arguments(design, options),
    )
    # for a single angle all steps are returned, because the figure needs them
    return found if len(angles) == 1 else found.isel(angle=np.cumsum([len(part) for part in parts]) - 1)
