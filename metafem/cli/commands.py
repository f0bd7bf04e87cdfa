"""Import of all commands: each module adds its commands to the group when it is imported."""

# ruff: noqa: F401
from metafem.cli import demo_and_design, doctor, explore, predict, report, spec
from metafem.cli.group import main as main
from metafem.cli.measurement import calibrate, compare, images, topography
from metafem.cli.study import comparisons, parameters, tolerances
