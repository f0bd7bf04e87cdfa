"""All commands of the group."""

from metafem.cli import demo_and_design, doctor, predict, report, spec
from metafem.cli.group import main
from metafem.cli.study import comparisons, tolerances

__all__ = ["comparisons", "demo_and_design", "doctor", "main", "predict", "report", "spec", "tolerances"]
