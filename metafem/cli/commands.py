"""All commands of the group."""

from metafem.cli import demo_and_design, doctor, predict, report, spec, study
from metafem.cli.group import main

__all__ = ["demo_and_design", "doctor", "main", "predict", "report", "spec", "study"]
