"""Studies of a design as datasets: its law under more detailed models, and the effects of interaction."""

from metafem.studies.fidelity import fidelity
from metafem.studies.interaction import interaction
from metafem.studies.summary import Summary, summary

__all__ = ["Summary", "fidelity", "interaction", "summary"]
