"""All commands of the group."""

from metafem.cli import demo_and_design, doctor, explore, predict, report, spec
from metafem.cli.group import main
from metafem.cli.measurement import calibrate, compare, images, topography
from metafem.cli.study import comparisons, parameters, tolerances

__all__ = [
    "calibrate",
    "compare",
    "comparisons",
    "demo_and_design",
    "doctor",
    "explore",
    "images",
    "main",
    "parameters",
    "predict",
    "report",
    "spec",
    "tolerances",
    "topography",
]
